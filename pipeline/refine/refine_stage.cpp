#include "pipeline/refine/refine_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "pipeline/executor/probe.h"
#include "pipeline/refine/cube_meshes.h"
#include "pipeline/stage/cube_mesh.h"
#include "stages/refine/mesh_part.h"
#include "stages/refine/retile.h"

namespace voxweld {
namespace {

// Labels of a unit are done one after the other: it takes the memory of the largest.
class RefineStage final : public StageWork {
 public:
  explicit RefineStage(RefineInputs inputs)
      : job_(inputs.job),
        units_(inputs.units),
        tile_vertices_(inputs.tile_vertices),
        meshes_(inputs.maker, std::move(inputs.meshes)),
        cubes_(job_.frame, job_.pass),
        // What comes out is read by the other pass, or by retile in blocks of the first one's cubes.
        cubes_after_(job_.frame, 1 - job_.pass),
        blocks_(tile_blocks(job_.frame)) {}

  Stage stage() const override { return job_.stage; }
  std::string noun() const override { return "ranges"; }
  std::string identity() const override { return job_.folder.filename().string(); }
  std::uint64_t size() const override { return units_.size(); }
  std::vector<Unit> units(std::span<const std::uint64_t> numbers) const override {
    std::vector<Unit> units;
    for (const std::uint64_t number : numbers) {
      const PlannedRange& range = units_[number].range;
      units.push_back(
          {number, units_[number].name(), static_cast<double>(range.vertices + range.polygons)});
    }
    return units;
  }
  bool done(std::uint64_t unit) override {
    const std::filesystem::path path = path_of(unit);
    return is_current(path, [&] { return CubeMeshArtifact(path).key() == key(unit, reads(unit)); });
  }

  StageMemory memory(std::span<const std::uint64_t> numbers) override {
    return {std::string(stage_name(job_.stage)), 0, largest_bytes(numbers),
            fmt::format("one range of cubes (output.tile_vertices = {})", tile_vertices_),
            "raise run.memory or lower output.tile_vertices"};
  }
  std::uint64_t bytes(std::uint64_t unit) override {
    std::uint64_t most = 0;
    for (const RangeReads& read : reads(unit)) most = std::max(most, bytes_of(read));
    return most;
  }
  void run(const Unit& unit, WorkerContext& worker) override {
    const std::vector<RangeReads> all = reads(unit.key);
    CubeMeshWriter file(path_of(unit.key), key(unit.key, all));
    RefineCounts counts;
    std::vector<BlockRecord> blocks;
    Changes changes = changes_before(unit.key);
    for (const RangeReads& read : all) {
      RefineCounts one;
      RefineMesh mesh = refine_range(read.read([&] { worker.check_interrupt(); }), cubes_,
                                     units_[unit.key].range.cubes, job_.parameters, one);
      if (job_.stage == Stage::seams) {
        add_blocks(read.label(), mesh, blocks);
        mesh.aims.clear();  // nobody asks for them any more
      }
      add_pieces(file, read.label(), mesh, cubes_after_);
      changes[read.label()] += one.collapses;  // each took a vertex
      counts.add(one);
    }
    file.finish(as_record(counts), blocks, records_of(changes));
  }

 private:
  using Changes = std::map<Material, std::uint64_t>;  // vertices that a label has lost

  static std::vector<LabelChange> records_of(const Changes& changes) {
    std::vector<LabelChange> records;
    for (const auto& [label, lost] : changes)
      if (lost > 0) records.push_back({label, lost});
    return records;
  }
  static std::uint64_t bytes_of(const RangeReads& read) {
    const PartCounts &all = read.all(), &own = read.own();
    // A vertex that goes or moves leaves a sample.
    const std::uint64_t samples = own.samples + own.vertices;
    const std::uint64_t reading =
        gather_bytes(all.vertices, all.triangles, all.samples, all.sided) +
        read.largest_part_bytes();
    const std::uint64_t refining = mesh_bytes(all.vertices, all.triangles, all.samples, all.sided) +
                                   refine_bytes({all.vertices, all.triangles, 0, all.sided},
                                                {own.vertices, own.triangles, samples, own.sided});
    const std::uint64_t writing = mesh_bytes(own.vertices, own.triangles, samples, own.sided) +
                                  piece_bytes(own.vertices, own.triangles, own.sided);
    return std::max({reading, refining, writing});
  }
  std::filesystem::path path_of(std::uint64_t unit) const {
    return refine_artifact_path(job_, units_[unit]);
  }
  // Of several labels one of each that is there.
  std::vector<RangeReads> reads(std::uint64_t number) {
    const RefineUnit& unit = units_[number];
    std::vector<RangeReads> reads;
    const auto labels = unit.labels > 1 ? meshes_.labels(unit.first_label, unit.end_label)
                                        : std::vector<Material>{unit.first_label};
    reads.reserve(labels.size());
    for (const Material label : labels)
      reads.emplace_back(meshes_, cubes_, label, unit.range.cubes);
    return reads;
  }
  // The units of seams are those of refine.
  Changes changes_before(std::uint64_t unit) {
    Changes changes;
    if (job_.stage == Stage::seams)
      for (const LabelChange& change : meshes_.open(unit)->changes())
        changes[change.label] = change.lost_vertices;
    return changes;
  }
  void add_blocks(Material label, const RefineMesh& mesh, std::vector<BlockRecord>& blocks) const {
    for (const CubeCount& block : count_blocks(mesh, blocks_))
      blocks.push_back({label, block.code, block.polygons});
  }
  Hash128 key(std::uint64_t number, const std::vector<RangeReads>& reads) {
    const RefineUnit& unit = units_[number];
    KeyHasher key;
    key.hash(job_.key)
        .integer(static_cast<std::int64_t>(unit.range.cubes.begin))
        .integer(static_cast<std::int64_t>(unit.range.cubes.end));
    for (const RangeReads& read : reads) {
      if (unit.of_labels()) key.integer(static_cast<std::int64_t>(read.label()));
      read.add_hashes(key);
    }
    key.bytes(as_section(records_of(changes_before(number))));
    return key.finish();
  }

  const RefineJob& job_;
  const std::vector<RefineUnit>& units_;
  std::uint64_t tile_vertices_;
  CubeMeshes meshes_;
  CubeLattice cubes_, cubes_after_, blocks_;
};

}  // namespace

std::unique_ptr<StageWork> refine_stage(RefineInputs inputs) {
  return std::make_unique<RefineStage>(std::move(inputs));
}

std::vector<std::filesystem::path> refined_meshes(const RefineJob& job,
                                                  const std::vector<RefineUnit>& units) {
  std::vector<std::filesystem::path> paths;
  paths.reserve(units.size());
  for (const RefineUnit& unit : units) paths.push_back(refine_artifact_path(job, unit));
  return paths;
}

RefineCounts refine_counts(const RefineJob& job, const std::vector<RefineUnit>& units) {
  const auto paths = refined_meshes(job, units);
  std::vector<RefineCounts> counts(paths.size());
  probe_all(paths.size(),
            [&](std::size_t i) { counts[i] = CubeMeshArtifact(paths[i]).counted<RefineCounts>(); });
  RefineCounts sum;
  for (const RefineCounts& one : counts) sum.add(one);
  return sum;
}

}  // namespace voxweld
