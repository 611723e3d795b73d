#include <fmt/format.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "pipeline/neuroglancer/fragment_pipe.h"
#include "pipeline/neuroglancer/multilod.h"
#include "pipeline/neuroglancer/world.h"
#include "stages/encode/fragment_index.h"
#include "storage/support/file_io.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

// Points of the fragments' grid in the world, each rounded to floats once: so points that two fragments
// share are the same bits.
class LegacyPoints {
 public:
  LegacyPoints(const Manifest& manifest, std::int32_t chunk, const FragmentCell& cell)
      : lattice_(manifest.lattice),
        matrix_(nanometre_matrix(manifest.frame)),
        fine_(fragment_range / chunk),
        cell_(cell) {}

  std::array<float, 3> of(const std::array<std::int32_t, 3>& q) const {
    std::array<double, 3> p{};
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int64_t grid = cell_[a] * fragment_range + q[a];
      p[a] = lattice_.origin[a] +
             static_cast<double>(grid) / static_cast<double>(fine_) * lattice_.step;
    }
    std::array<float, 3> world{};
    for (std::size_t r = 0; r < 3; ++r)
      world[r] = static_cast<float>(matrix_[4 * r] * p[0] + matrix_[4 * r + 1] * p[1] +
                                    matrix_[4 * r + 2] * p[2] + matrix_[4 * r + 3]);
    return world;
  }

 private:
  const OutputLattice& lattice_;
  const std::array<double, 12> matrix_;
  const std::int64_t fine_;
  const FragmentCell cell_;
};

struct LegacyFragment {
  std::vector<std::byte> bytes;
  std::uint64_t triangles = 0;
};

LegacyFragment legacy_fragment(const FragmentMesh& mesh, const LegacyPoints& points,
                               bool mirrored) {
  LegacyFragment out{{}, mesh.triangles.size()};
  out.bytes.resize(4 + 12 * mesh.positions.size() + 12 * mesh.triangles.size());
  std::byte* at = out.bytes.data();
  const auto put = [&at](const auto& value) {  // in the machine's order, which is little-endian
    std::memcpy(at, &value, sizeof value);
    at += sizeof value;
  };
  put(static_cast<std::uint32_t>(mesh.positions.size()));
  for (const auto& q : mesh.positions) put(points.of(q));
  for (std::array<std::uint32_t, 3> t : mesh.triangles) {
    if (mirrored) std::swap(t[1], t[2]);
    put(t);
  }
  return out;
}

class LegacyWriter {
 public:
  LegacyWriter(const SegmentList& list, const std::filesystem::path& folder,
               NeuroglancerTotals& totals)
      : list_(list), folder_(folder), totals_(totals) {}

  void add(const FragmentSort::Key& key, const LegacyFragment& fragment) {
    const std::uint64_t id = list_.segments[key.segment].id;
    if (!names_.empty() && id != id_) finish();
    id_ = id;
    names_.push_back(fmt::format("{}:0:{}", id, names_.size()));
    put(names_.back(), fragment.bytes);
    totals_.triangles += fragment.triangles;
    ++totals_.fragments;
  }
  void finish() {
    if (names_.empty()) return;
    const std::string text = json_text(nlohmann::json{{"fragments", names_}});
    put(fmt::format("{}:0", id_), as_bytes(text));
    names_.clear();
    ++totals_.objects;
  }

 private:
  void put(const std::string& name, std::span<const std::byte> bytes) {
    write_whole_file(folder_ / name, bytes, Durability::rename_only);
    totals_.bytes += bytes.size();
    ++totals_.files;
  }

  const SegmentList& list_;
  const std::filesystem::path& folder_;
  NeuroglancerTotals& totals_;
  std::uint64_t id_ = 0;
  std::vector<std::string> names_;  // of the object's fragments
};

}  // namespace

void write_legacy(FragmentSort& sort, const FragmentWork& work, const std::filesystem::path& folder,
                  NeuroglancerTotals& totals) {
  LegacyWriter writer(work.list, folder, totals);
  const bool mirrored = is_mirrored(work.manifest.frame);
  for_each_fragment<LegacyFragment>(
      sort, work.threads, work.interrupt,
      [&](const FragmentSort::Key& key, const std::vector<FragmentTriangle>& triangles) {
        const LegacyPoints points(work.manifest, work.list.segments[key.segment].chunk,
                                  fragment_cell(key.code));
        return legacy_fragment(weld_fragment(triangles), points, mirrored);
      },
      [&](const FragmentSort::Key& key, const LegacyFragment& fragment) {
        writer.add(key, fragment);
      });
  writer.finish();
}

}  // namespace voxweld
