// Mesh files, and the summaries that list them.
#include <algorithm>

#include "pipeline/config/config.h"
#include "pipeline/info/kinds.h"
#include "pipeline/output/load.h"
#include "pipeline/output/render.h"
#include "stages/solids/mesh_boundary.h"
#include "storage/manifest/manifest.h"
#include "storage/meshes/mesh_file.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

std::uint64_t distinct(std::vector<std::array<float, 3>> positions) {
  std::ranges::sort(positions);
  return static_cast<std::uint64_t>(std::unique(positions.begin(), positions.end()) -
                                    positions.begin());
}

InfoDocument file_facts(const FileRecord& file) {
  return {{"path", file.path},
          {"format", file.format},
          {"role", file.role},
          {"bytes", file.bytes},
          {"xxh3_128", file.xxh3_128}};
}

InfoDocument frame_facts(const VolumeGeometry& frame) {
  InfoDocument direction = InfoDocument::array();
  for (const Vec3& axis : frame.direction) direction.push_back(facts_of(axis));
  return {{"size", facts_of(frame.size)},
          {"spacing", facts_of(frame.spacing)},
          {"unit", frame.unit},
          {"first", facts_of(frame.first)},
          {"origin", facts_of(frame.origin)},
          {"direction", std::move(direction)},
          {"space", frame.space}};
}

InfoDocument count_facts(const ManifestCounts& counts, bool labels) {
  InfoDocument facts = {{"bricks", counts.bricks},
                        {"active_bricks", counts.active_bricks},
                        {"collapsed_above_bricks", counts.collapsed_above},
                        {"leaves", counts.leaves},
                        {"vertices", counts.vertices},
                        {"quads", counts.quads},
                        {"polygon_triangles", counts.polygon_triangles},
                        {"triangles", counts.triangles},
                        {"tiles", counts.tiles},
                        {"collinear", counts.collinear}};
  if (labels) facts["labels"] = counts.labels;
  return facts;
}

// f of every file the directory lists: those of the manifest, then each tile's.
template <class F>
void for_each_file(const fs::path& directory, const Manifest& manifest, F&& f) {
  for (const FileRecord& file : manifest.files) f(file);
  for (const char* list : {tiles_name, levels_name}) {
    if (!fs::exists(directory / list)) continue;  // said of the list itself
    TileListReader tiles(directory / list);
    while (const auto tile = tiles.next())
      for (const FileRecord& file : tile->files) f(file);
  }
}

// Sizes and hashes of the files; whether they weld is for `voxweld verify` to say.
InfoDocument check_files(const fs::path& directory, const Manifest& manifest,
                         const InfoOptions& options) {
  CheckResult check;
  for_each_file(directory, manifest, [&](const FileRecord& file) {
    const fs::path path = directory / file.path;
    if (!fs::exists(path)) return check.damaged(path.string(), "missing");
    check.read(fs::file_size(path));
    if (fs::file_size(path) != file.bytes ||
        to_hex(hash_file(path, options.hooks.interrupt)) != file.xxh3_128)
      check.damaged(path.string(), "is not what the manifest says; run again");
  });
  return check.facts();
}

// What the meshes are of and what they are made with: the settings that a reader of the meshes asks
// for. Those of another version may not be understood; they are left out then.
void add_settings(InfoDocument& document, const Manifest& manifest) {
  const auto text_of = [&](const char* key) {
    const bool there = manifest.config && manifest.config->contains(key);
    return there ? manifest.config->at(key).get<std::string>() : std::string();
  };
  InfoDocument facts;
  try {
    facts = settings_facts(parse_config(text_of("toml"), text_of("path")));
  } catch (const InputError&) {
    return;
  } catch (const nlohmann::json::exception&) {
    return;
  }
  document["config"] = text_of("path");
  // Where labels are meshed, the surface's table says nothing, else theirs.
  for (const char* table :
       {manifest.labels == LabelMode::off ? "surface" : "labels", "simplify", "filter", "edit"})
    if (facts.contains(table)) document[table] = facts[table];
}

}  // namespace

InfoDocument describe_mesh(const fs::path& path) {
  const DecodedMesh mesh = load_mesh(path);
  InfoDocument document = file_document("mesh", path);
  document["format"] = writer_of_file(mesh_writers(), path.filename().string())->name;
  document["points"] = mesh.positions.size();
  document["vertices"] = distinct(mesh.positions);
  document["triangles"] = mesh.triangles.size();
  document["normals"] = !mesh.normals.empty();
  const MeshBounds bounds = bounds_of(std::span(&mesh, 1));
  document["bounds"] = {{"lo", facts_of(bounds.lo)}, {"hi", facts_of(bounds.hi)}};
  return document;
}

InfoDocument describe_input_mesh(const InfoOptions& options) {
  constexpr std::size_t holes_told = 10;
  const fs::path path = options.input.path;
  const MeshFile file = read_mesh_file(path);
  const Bounds bounds = bounds_of(file.mesh);
  const MeshBoundary boundary = boundary_of(file.mesh);
  InfoDocument document = file_document("input_mesh", path);
  document["format"] = file.format;
  document["vertices"] = file.mesh.vertices.size();
  document["triangles"] = file.mesh.triangles.size();
  document["bounds"] = {{"lo", facts_of(bounds.lo)}, {"hi", facts_of(bounds.hi)}};
  document["size"] = facts_of(bounds.hi - bounds.lo);
  document["volume"] = signed_volume(file.mesh);
  document["closed"] = boundary.closed();
  document["boundary_edges"] = boundary.edges;
  document["holes"] = boundary.holes.size();
  const std::size_t told = options.verbose ? boundary.holes.size() : holes_told;
  document["hole_list"] = InfoDocument::array();
  for (std::size_t i = 0; i < std::min(told, boundary.holes.size()); ++i) {
    const MeshHole& hole = boundary.holes[i];
    document["hole_list"].push_back(
        {{"edges", hole.edges}, {"size", hole.size}, {"center", facts_of(hole.center)}});
  }
  // Reading it was that: a foreign file has no checksum.
  if (options.check) document["check"] = CheckResult().read(document["bytes"]).facts();
  return document;
}

InfoDocument describe_output(const fs::path& manifest_path, const InfoOptions& options) {
  const Manifest manifest = read_manifest(manifest_path);
  const fs::path directory = manifest_path.parent_path();
  InfoDocument document = new_document("output", options.input.path);
  document["bytes"] = manifest.counts.bytes;
  document["border"] = manifest.open_border ? "open" : "closed";
  document["topology"] = manifest.free_topology ? "free" : "safe";
  document["frame"] = frame_facts(manifest.frame);
  document["lattice"] = facts_of(manifest.lattice);
  document["counts"] = count_facts(manifest.counts, manifest.labels == LabelMode::each);
  document["files"] = {{"count", manifest.counts.files}, {"bytes", manifest.counts.bytes}};
  document["merged"] = nullptr;
  if (manifest.merged) {
    document["merged"] = InfoDocument::object();
    for (const auto& [format, file] : *manifest.merged) document["merged"][format] = file;
  }
  if (manifest.error) document["error"] = *manifest.error;
  if (manifest.refine) document["refine"] = *manifest.refine;
  if (manifest.levels) document["levels"] = *manifest.levels;
  if (manifest.input) document["input"] = *manifest.input;
  add_settings(document, manifest);
  if (options.verbose) {
    document["file_list"] = InfoDocument::array();
    for_each_file(directory, manifest, [&](const FileRecord& file) {
      document["file_list"].push_back(file_facts(file));
    });
  }
  if (options.check) document["check"] = check_files(directory, manifest, options);
  return document;
}

InfoDocument describe_tile_list(const fs::path& path, const InfoOptions& options) {
  InfoDocument document = file_document("tile_list", path);
  std::uint64_t tiles = 0, vertices = 0, triangles = 0, files = 0, bytes = 0;
  InfoDocument list = InfoDocument::array();
  TileListReader reader(path);
  while (const auto tile = reader.next()) {
    ++tiles;
    vertices += tile->vertices;
    triangles += tile->triangles;
    files += tile->files.size();
    for (const FileRecord& file : tile->files) bytes += file.bytes;
    if (options.verbose)
      list.push_back({{"level", tile->tile.level},
                      {"at", facts_of(tile->tile.at)},
                      {"vertices", tile->vertices},
                      {"triangles", tile->triangles}});
  }
  document["tiles"] = tiles;
  document["vertices"] = vertices;
  document["triangles"] = triangles;
  document["files"] = files;
  document["file_bytes"] = bytes;
  if (options.verbose) document["tile_list"] = list;
  return document;
}

}  // namespace voxweld
