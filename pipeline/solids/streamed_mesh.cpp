#include "pipeline/solids/streamed_mesh.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/executor/probe.h"
#include "pipeline/solids/binned_mesh.h"
#include "pipeline/solids/closed_mesh.h"
#include "pipeline/solids/mesh_survey.h"
#include "pipeline/stage/file_layout.h"
#include "pipeline/stage/shard_memory.h"
#include "pipeline/stage/volume.h"
#include "stages/solids/local_mesh.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t least_memory = std::uint64_t{20} << 20;
constexpr std::uint64_t buffers = std::uint64_t{6} << 20;  // of files, beside what work takes

fs::path record_path(const fs::path& folder) {
  return folder / "mesh";
}

Hash128 record_key(const fs::path& path) {
  KeyHasher key;
  key.text("mesh").integer(mesh_record_version).text(path.string());
  return key.finish();
}

std::optional<MeshRecord> recorded(const fs::path& path, const fs::path& folder) {
  const auto state = file_state(path);
  if (!fs::exists(record_path(folder)) || !state) return std::nullopt;
  try {
    const MeshRecord record = read_mesh_record(record_path(folder), record_key(path));
    if (record.file != *state) return std::nullopt;
    return record;
  } catch (const DamagedArtifact&) {
    return std::nullopt;
  }
}

MeshWork work_for(const Config& config, const fs::path& folder, const InterruptFlag* interrupt) {
  StageMemory need = streaming_memory();
  need.base_bytes += program_bytes();
  threads_within({config.run.memory}, need, 1);
  MeshWork work{folder, config.run.memory - program_bytes() - buffers, {}};
  work.between = [interrupt] {
    if (interrupt != nullptr) interrupt->check();
  };
  return work;
}

MeshRecord record_of(const SpooledMesh& mesh) {
  const MeshFacts& file = mesh.file();
  return {file.content,     file.state,       mesh.vertices(),         mesh.triangles(),
          mesh.bounds().lo, mesh.bounds().hi, mesh.vertex_bounds().lo, mesh.vertex_bounds().hi};
}

MeshBinning binning_of(const Config& config, const MeshRecord& record, const fs::path& folder) {
  const VolumeGeometry geometry = mesh_geometry(config.input, {record.lo, record.hi});
  KeyHasher key;
  key.text("mesh bins").integer(mesh_bins_version).hash(record.content);
  for (int a = 0; a < 3; ++a)
    key.integer(geometry.size[a]).real(geometry.spacing[a]).real(geometry.first[a]);
  key.integer(config.work.brick).integer(config.work.shard);
  const Hash128 hash = key.finish();
  return {brick_grid(config, geometry), geometry, folder / ("mesh-" + short_hex(hash)), hash,
          record.content};
}

std::shared_ptr<MeshVolume> volume_of(const MeshBinning& binning, const MeshRecord& record) {
  const VolumeGeometry& geometry = binning.geometry;
  const auto snapped = [&](Vec3 place) {
    return snapped_corner(in_frame(place, geometry), geometry.spacing);
  };
  Solid solid;
  solid.shape = SolidShape::mesh;
  solid.center = Vec3{} - geometry.first;
  solid.mesh = std::make_shared<BinnedMesh>(
      binning, snapped_bounds(snapped(record.all_lo), snapped(record.all_hi), geometry.spacing));
  return std::make_shared<MeshVolume>(geometry, std::move(solid));
}

// Of another file than the one that was planned with.
void check_same(const StreamedMesh& mesh, const SpooledMesh& spooled) {
  if (spooled.file().content == mesh.record.content) return;
  throw InputError(mesh.path.string() +
                   ": the mesh has changed since this run began; start it again");
}

}  // namespace

bool streams_mesh(const Config& config) {
  const InputConfig& input = config.input;
  return input.is_mesh() && input.close == MeshClosing::no && is_mesh_name(input.path) &&
         !mesh_fits(input.path, config.run.memory, input.close);
}

std::shared_ptr<StreamedMesh> plan_streamed_mesh(const Config& config, const fs::path& folder,
                                                 const InterruptFlag* interrupt) {
  const fs::path& path = config.input.path;
  auto mesh = std::make_shared<StreamedMesh>(StreamedMesh{
      path, folder, {}, {BrickGrid({1, 1, 1}, 3, 1), {}, {}, {}, {}}, nullptr, nullptr});
  if (const auto known = recorded(path, folder)) {
    mesh->record = *known;
  } else {
    spdlog::info("{}: the mesh does not fit run.memory; it is read by pieces, through {}",
                 path.string(), folder.string());
    MeshWork work = work_for(config, folder, interrupt);
    work.progress = progress_lines(path);
    mesh->spooled = std::make_shared<SpooledMesh>(path, work);
    check_spooled_mesh(path, *mesh->spooled, work);
    mesh->record = record_of(*mesh->spooled);
    write_mesh_record(record_path(folder), record_key(path), mesh->record);
  }
  mesh->binning = binning_of(config, mesh->record, folder);
  mesh->volume = volume_of(mesh->binning, mesh->record);
  return mesh;
}

bool bins_are_current(const StreamedMesh& mesh) {
  const MeshBinning& binning = mesh.binning;
  if (!fs::exists(binning.table_path())) return false;
  std::vector<Index3> reached;
  try {
    const MeshTable table = read_mesh_table(binning.table_path(), binning.key);
    for (const Index3& shard : binning.grid.all_shards()) {
      const std::uint64_t number = binning.shard_number(shard);
      if (number >= table.shards.size()) return false;
      if (table.shards[number] == MeshSide::reached) reached.push_back(shard);
    }
  } catch (const DamagedArtifact&) {
    return false;
  }
  return probe_which(reached.size(),
                     [&](std::size_t i) { return !fs::exists(binning.bins_path(reached[i])); })
      .empty();
}

StageMemory streaming_memory() {
  return {"ingest", 0, least_memory, "a mesh that is read by pieces", "raise run.memory"};
}

void make_bins(const Config& config, StreamedMesh& mesh, const InterruptFlag* interrupt) {
  const MeshWork work = work_for(config, mesh.folder, interrupt);
  if (mesh.spooled == nullptr) {
    mesh.spooled = std::make_shared<SpooledMesh>(mesh.path, work);
    check_same(mesh, *mesh.spooled);
  }
  const std::uint64_t budget = config.run.memory;
  const std::uint64_t building =
      program_bytes() +
      shard_memory(mesh.binning.grid, SampleType::u8, {.by_sheets = collapses_by_sheets(config)})
          .whole();
  const BinLimits limits{budget, work.memory - work.memory / 3,
                         budget > building ? budget - building : 0};
  bin_mesh(*mesh.spooled, mesh.binning, work, limits);
  mesh.spooled.reset();
}

LargestBin largest_bin(const StreamedMesh& mesh) {
  const MeshTable table = read_mesh_table(mesh.binning.table_path(), mesh.binning.key);
  const std::int64_t side = (std::int64_t{1} << mesh.binning.grid.brick_level()) + 3;
  const auto shard = static_cast<std::uint64_t>(mesh.binning.grid.shard_bricks({}).count());
  return {LocalMesh::memory_bytes(table.facts.largest, {{}, splat(side)}), table.facts.largest,
          BinnedMesh::open_shards * shard * (2 * sizeof(SectionRecord) + 1)};
}

}  // namespace voxweld
