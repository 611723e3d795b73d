#include "pipeline/neuroglancer/multilod.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/neuroglancer/fragment_pipe.h"
#include "stages/encode/fragment_index.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

struct EncodedFragment {
  std::vector<std::byte> bytes;
  std::uint8_t octants = 0;
  std::uint64_t triangles = 0;
};

EncodedFragment encoded(const FragmentSort::Key& key,
                        const std::vector<FragmentTriangle>& triangles) {
  EncodedFragment out{encode_fragment(weld_fragment(triangles)), 0, triangles.size()};
  if (out.bytes.size() > std::numeric_limits<std::uint32_t>::max())
    throw InputError(
        "a fragment of more than 4 GiB; make the mesh coarser with simplify.tolerance");
  if (key.lod > 0)
    for (const FragmentTriangle& t : triangles)
      out.octants = static_cast<std::uint8_t>(out.octants | 1u << octant_of(t));
  return out;
}

class MultilodWriter {
 public:
  MultilodWriter(const FragmentSort& sort, const FragmentWork& work, ObjectStore& store,
                 NeuroglancerTotals& totals)
      : sort_(sort), work_(work), store_(store), totals_(totals) {}

  void add(const FragmentSort::Key& key, const EncodedFragment& fragment) {
    if (!open_ || key.segment != segment_) begin(key.segment);
    store_.append(id(), fragment.bytes);
    levels_[static_cast<std::size_t>(key.lod)].fragments.push_back(
        {key.code, static_cast<std::uint32_t>(fragment.bytes.size()), fragment.octants});
    totals_.triangles += fragment.triangles;
    ++totals_.fragments;
  }
  void finish() {
    if (open_) end();
    store_.close();
    totals_.bytes += store_.bytes();
    totals_.files += store_.files();
  }

 private:
  std::uint64_t id() const { return work_.list.segments[segment_].id; }
  void begin(std::size_t segment) {
    if (open_) end();
    open_ = true;
    segment_ = segment;
    levels_.assign(static_cast<std::size_t>(work_.levels), {});
  }
  void end() {
    const OutputLattice& lattice = work_.manifest.lattice;
    float before = 0;
    for (int lod = 0; lod < work_.levels; ++lod) {
      FragmentLevel& level = levels_[static_cast<std::size_t>(lod)];
      before = level.scale = std::max(before, scale(lod));
    }
    // Labels that are smaller than a level's tolerance are not in it.
    while (levels_.size() > 1 && levels_.back().fragments.empty()) levels_.pop_back();
    add_empty_fragments(levels_);
    FragmentIndex index;
    const std::int32_t chunk = work_.list.segments[segment_].chunk;
    for (std::size_t a = 0; a < 3; ++a) {  // exact, as coordinates of the lattice are
      index.chunk_shape[a] = static_cast<float>(chunk * lattice.step);
      index.grid_origin[a] = static_cast<float>(lattice.origin[a]);
    }
    index.levels = std::move(levels_);
    store_.finish(id(), index_bytes(index));
    ++totals_.objects;
    open_ = false;
  }
  // The side of a triangle of mean area, were its sides equal (lod_scale_multiplier).
  float scale(int lod) const {
    const SegmentLevel& level = sort_.level(segment_, lod);
    if (level.triangles == 0) return 0;
    const double area = level.area2 / 2 / static_cast<double>(level.triangles);
    return static_cast<float>(std::sqrt(area * 4 / std::sqrt(3.0)) * work_.manifest.lattice.step);
  }

  const FragmentSort& sort_;
  const FragmentWork& work_;
  ObjectStore& store_;
  NeuroglancerTotals& totals_;
  bool open_ = false;
  std::size_t segment_ = 0;
  std::vector<FragmentLevel> levels_;
};

}  // namespace

void write_multilod(FragmentSort& sort, const FragmentWork& work, ObjectStore& store,
                    NeuroglancerTotals& totals) {
  MultilodWriter writer(sort, work, store, totals);
  for_each_fragment<EncodedFragment>(
      sort, work.threads, work.interrupt, encoded,
      [&](const FragmentSort::Key& key, const EncodedFragment& fragment) {
        writer.add(key, fragment);
      });
  writer.finish();
}

}  // namespace voxweld
