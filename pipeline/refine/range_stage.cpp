#include "pipeline/refine/range_stage.h"

#include <fmt/format.h>

#include <algorithm>

#include "stages/refine/mesh_part.h"

namespace voxweld {
RangeStage::RangeStage(const RefineInputs& inputs)
    : job_(inputs.job),
      units_(inputs.units),
      tile_vertices_(inputs.tile_vertices),
      meshes_(inputs.meshes),
      cubes_(job_.frame, job_.pass) {}

std::vector<Unit> RangeStage::units(std::span<const std::uint64_t> numbers) const {
  std::vector<Unit> units;
  for (const std::uint64_t number : numbers) {
    const PlannedRange& range = units_[number].range;
    units.push_back(
        {number, units_[number].name(), static_cast<double>(range.vertices + range.polygons)});
  }
  return units;
}

StageMemory RangeStage::memory(std::span<const std::uint64_t> numbers) {
  return {std::string(stage_name(job_.stage)), 0, largest_bytes(numbers),
          fmt::format("one range of cubes (output.tile_vertices = {})", tile_vertices_),
          "raise run.memory or lower output.tile_vertices"};
}

std::uint64_t RangeStage::bytes(std::uint64_t unit) {
  std::uint64_t most = 0;
  for (const RangeReads& read : reads(unit)) {
    PartCounts own = read.own();
    own.samples += own.vertices;  // a vertex that goes or moves leaves one
    most = std::max({most, reading_bytes(read.all(), read.largest_part_bytes()),
                     refining_bytes(read.all(), own),
                     mesh_bytes(own.vertices, own.triangles, own.samples, own.sided) +
                         piece_bytes(own.vertices, own.triangles, own.sided)});
  }
  return most;
}

std::uint64_t RangeStage::reading_bytes(const PartCounts& all, std::uint64_t largest_part) {
  return gather_bytes(all.vertices, all.triangles, all.samples, all.sided) + largest_part;
}

std::uint64_t RangeStage::refining_bytes(const PartCounts& all, const PartCounts& own) {
  return mesh_bytes(all.vertices, all.triangles, all.samples, all.sided) +
         refine_bytes({all.vertices, all.triangles, 0, all.sided},
                      {own.vertices, own.triangles, own.samples, own.sided});
}

std::vector<RangeReads> RangeStage::reads(std::uint64_t number) {
  const RefineUnit& unit = units_[number];
  std::vector<RangeReads> reads;
  const auto labels = unit.labels > 1 ? meshes_.labels(unit.first_label, unit.end_label)
                                      : std::vector<Material>{unit.first_label};
  reads.reserve(labels.size());
  for (const Material label : labels) reads.emplace_back(meshes_, cubes_, label, unit.range.cubes);
  return reads;
}

KeyHasher RangeStage::begin_key(std::uint64_t unit) const {
  KeyHasher key;
  key.hash(job_.key)
      .integer(static_cast<std::int64_t>(range_of(unit).begin))
      .integer(static_cast<std::int64_t>(range_of(unit).end));
  return key;
}

KeyHasher RangeStage::key_of(std::uint64_t number, const std::vector<RangeReads>& reads) const {
  const RefineUnit& unit = units_[number];
  KeyHasher key = begin_key(number);
  for (const RangeReads& read : reads) {
    if (unit.of_labels()) key.integer(static_cast<std::int64_t>(read.label()));
    read.add_hashes(key);
  }
  return key;
}

}  // namespace voxweld
