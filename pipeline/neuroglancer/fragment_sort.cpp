#include "pipeline/neuroglancer/fragment_sort.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <map>
#include <unordered_map>
#include <utility>

#include "pipeline/output/level_cut.h"
#include "pipeline/output/tile_stream.h"
#include "stages/encode/fragment_index.h"
#include "stages/encode/lattice_mesh.h"
#include "stages/encode/mesh_writers.h"
#include "stages/exact/orientation.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/hash.h"

namespace voxweld {
namespace {

// Records that are held before they are written to a scratch file.
constexpr std::uint64_t sort_memory = std::uint64_t{128} << 20;

using Corners = std::array<LatticePoint, 3>;

double area2_of(const Corners& p) {
  const Index3 n = exact_normal(p[0], p[1], p[2]);
  double squared = 0;
  for (int a = 0; a < 3; ++a) squared += static_cast<double>(n[a]) * static_cast<double>(n[a]);
  return std::sqrt(squared);
}

DecodedMesh read_checked(const MeshWriter& format, const std::filesystem::path& path,
                         const FileRecord& record) {
  const std::vector<std::byte> bytes = read_whole_file(path);
  if (to_hex(hash_bytes(bytes)) != record.xxh3_128)
    throw FormatError(path.string() +
                      ": is not what the run wrote: its hash is another one than that in the list "
                      "of tiles; run `voxweld run` again, which mends it");
  return format.read(bytes, path.string());
}

// The tile's first file that says all there is to know.
LatticeMesh read_tile(const std::filesystem::path& output, const TileRecord& record,
                      const Manifest& manifest) {
  for (const FileRecord& file : record.files) {
    const MeshWriter* format = writer_of_file(mesh_writers(), file.path);
    const bool many_labels = manifest.labels == LabelMode::shared ||
                             (manifest.labels == LabelMode::each && record.lod > 0);
    if (format == nullptr || (many_labels && !format->holds_labels)) continue;
    const std::filesystem::path path = output / file.path;
    return weld(read_checked(*format, path, file), manifest.lattice, path.string());
  }
  throw InputError(
      fmt::format("{}: its tiles have no file that says which labels meet; set output.formats to "
                  "[\"drc\"], and run again",
                  output.string()));
}

}  // namespace

// What a tile gives.
struct FragmentSort::TileWork {
  std::map<SortKey, std::vector<FragmentTriangle>> fragments;
  std::map<std::size_t, SegmentLevel> levels;  // by place
};

namespace {

// The fragments of one object's triangles.
class ObjectCutter {
 public:
  ObjectCutter(std::uint64_t major, FragmentGrid grid) : major_(major), cutter_(grid) {}

  void add(const Corners& corners) {
    for (const FragmentCutter::Piece& piece : cutter_.cut(corners)) {
      const std::uint64_t code = fragment_code(piece.cell);
      if (last_ == nullptr || code != last_code_) {
        last_ = &fragments_[code];
        last_code_ = code;
      }
      last_->push_back(piece.corners);
    }
    ++level_.triangles;
    level_.area2 += area2_of(corners);
  }
  const SegmentLevel& level() const { return level_; }
  void move_into(std::map<SortKey, std::vector<FragmentTriangle>>& all) {
    for (auto& [code, triangles] : fragments_) all[{major_, code}] = std::move(triangles);
  }

 private:
  std::uint64_t major_;
  FragmentCutter cutter_;
  std::unordered_map<std::uint64_t, std::vector<FragmentTriangle>> fragments_;
  std::vector<FragmentTriangle>* last_ = nullptr;
  std::uint64_t last_code_ = 0;
  SegmentLevel level_;
};

// The labels that a triangle bounds; of one that has a second label behind it the other way around.
template <class Add>
void each_owner(const LatticeMesh& mesh, std::size_t i, const TileRecord& record, Add add) {
  const Triangle& t = mesh.triangles[i];
  const Corners out{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
  if (mesh.pairs.empty()) return add(record.label.value_or(sole_material), out);
  const MaterialPair& pair = mesh.pairs[i];
  if (pair.inside != exterior) add(pair.inside, out);
  if (pair.outside != exterior) add(pair.outside, Corners{out[0], out[2], out[1]});
}

}  // namespace

FragmentSort::FragmentSort(Source source, const std::filesystem::path& scratch)
    : source_(std::move(source)),
      place_(source_.order.size()),
      levels_(source_.order.size() * static_cast<std::size_t>(source_.levels)),
      sorter_(scratch, sort_memory) {
  for (std::size_t i = 0; i < source_.order.size(); ++i) place_[source_.order[i]] = i;
}

void FragmentSort::sort(int threads, const InterruptFlag* interrupt) {
  for (int lod = 0; lod < source_.levels; ++lod) sort_level(lod, threads, interrupt);
}

void FragmentSort::sort_level(int lod, int threads, const InterruptFlag* interrupt) {
  const std::vector<LevelTile> coarser =
      lod == 0 ? std::vector<LevelTile>{} : listed_levels(source_.output);
  const LevelCut cut(coarser, lod);
  const auto levels = static_cast<std::size_t>(source_.levels);
  const auto work = [&](const TileRecord& record, std::size_t) {
    if (interrupt != nullptr) interrupt->check();
    TileWork done;
    if (record.files.empty()) return done;
    const LatticeMesh mesh = read_tile(source_.output, record, source_.manifest);
    std::unordered_map<Material, std::optional<ObjectCutter>> cutters;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      each_owner(mesh, i, record, [&](Material label, const Corners& corners) {
        const auto [at, is_new] = cutters.try_emplace(label);
        if (is_new) {
          if (const auto segment = source_.list.find(label))
            at->second.emplace(place_[*segment] * levels + static_cast<std::size_t>(lod),
                               FragmentGrid{source_.list.segments[*segment].chunk, lod});
        }
        if (at->second) at->second->add(corners);
      });
    for (auto& [label, cutter] : cutters) {
      if (!cutter) continue;
      done.levels[place_[*source_.list.find(label)]] = cutter->level();
      cutter->move_into(done.fragments);
    }
    return done;
  };
  const auto fold = [&](const TileWork& done) {
    for (const auto& [place, level] : done.levels) {
      SegmentLevel& sum = levels_[place * levels + static_cast<std::size_t>(lod)];
      sum.triangles += level.triangles;
      sum.area2 += level.area2;
    }
    for (const auto& [key, triangles] : done.fragments)
      sorter_.push(key, std::as_bytes(std::span(triangles)));
  };
  for (const char* list : {tiles_name, levels_name}) {
    if (list == levels_name && lod == 0) continue;
    for_each_taken<TileWork>(
        source_.output / list, threads, [&](const TileRecord& record) { return cut.takes(record); },
        work, fold);
  }
}

FragmentSort::Key FragmentSort::key_of(const SortKey& key) const {
  const auto levels = static_cast<std::uint64_t>(source_.levels);
  return {source_.order[key.major / levels], static_cast<int>(key.major % levels), key.minor};
}

bool FragmentSort::next(Key& key, std::vector<FragmentTriangle>& triangles) {
  if (!begun_) more_ = sorter_.next(held_key_, held_);
  begun_ = true;
  triangles.clear();
  if (!more_) return false;
  const SortKey first = held_key_;
  key = key_of(first);
  while (more_ && held_key_ == first) {
    const std::size_t at = triangles.size();
    triangles.resize(at + held_.size() / sizeof(FragmentTriangle));
    std::memcpy(triangles.data() + at, held_.data(), held_.size());
    more_ = sorter_.next(held_key_, held_);
  }
  return true;
}

}  // namespace voxweld
