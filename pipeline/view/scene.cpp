#include "pipeline/view/scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>

#include "pipeline/view/page_files.h"
#include "stages/encode/glb.h"
#include "stages/encode/label_colour.h"
#include "stages/encode/mesh_writers.h"
#include "storage/manifest/manifest.h"
#include "storage/manifest/report_file.h"
#include "storage/support/error.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

Json json_of(Vec3 v) {
  return {v.x, v.y, v.z};
}

Json box_json(Vec3 lo, Vec3 hi) {
  return {{"lo", json_of(lo)}, {"hi", json_of(hi)}};
}

Json json_of(const VolumeGeometry& frame) {
  Json direction = Json::array();
  for (const Vec3& d : frame.direction) direction.push_back(json_of(d));
  return {{"size", {frame.size.x, frame.size.y, frame.size.z}},
          {"spacing", json_of(frame.spacing)},
          {"first", json_of(frame.first)},
          {"origin", json_of(frame.origin)},
          {"direction", direction},
          {"space", frame.space}};
}

// Where sample `at` lies in the files.
Vec3 place_of(const VolumeGeometry& frame, Vec3 at) {
  Vec3 place = frame.first;
  for (int axis = 0; axis < 3; ++axis) place[axis] += frame.spacing[axis] * at[axis];
  return place;
}

// Cells begin one sample before the volume, which a cap of the border may reach into.
Json tile_box(const VolumeGeometry& frame, const CellKey& tile) {
  const Vec3 first = as_vec3(tile.at) * static_cast<double>(tile.side()) - Vec3{1, 1, 1};
  const double side = static_cast<double>(tile.side());
  const Vec3 end = first + Vec3{side, side, side};
  return box_json(place_of(frame, max(first, Vec3{-1, -1, -1})),
                  place_of(frame, min(end, as_vec3(frame.size))));
}

Json json_of(const FileRecord& file) {
  return {{"format", file.format}, {"path", file.path}, {"bytes", file.bytes}};
}

Json json_of(const TileRecord& tile, const VolumeGeometry& frame) {
  Json out = {{"level", tile.tile.level},
              {"at", {tile.tile.at.x, tile.tile.at.y, tile.tile.at.z}},
              {"box", tile_box(frame, tile.tile)},
              {"triangles", tile.triangles},
              {"vertices", tile.vertices}};
  if (tile.label) out["label"] = fmt::to_string(*tile.label);
  out["files"] = Json::array();
  for (const FileRecord& file : tile.files) out["files"].push_back(json_of(file));
  return out;
}

Json json_of(const LabelRecord& label) {
  MaterialTable table;
  if (const auto& c = label.color)
    table.entries.push_back({label.label, {}, MaterialColor{(*c)[0], (*c)[1], (*c)[2]}});
  const auto colour = given_colour(table, label.label);
  return {{"label", fmt::to_string(label.label)},
          {"name", label.name},
          {"colour", colour.value_or(label_colour(label.label))},
          {"triangles", label.triangles},
          {"volume", label.volume ? Json(*label.volume) : Json(nullptr)},
          {"area", label.area},
          {"bounds", label.bounds ? box_json(label.bounds->lo, label.bounds->hi) : Json(nullptr)}};
}

Json json_of(const ManifestCounts& counts) {
  return {{"vertices", counts.vertices}, {"triangles", counts.triangles}, {"tiles", counts.tiles},
          {"bricks", counts.bricks},     {"leaves", counts.leaves},       {"files", counts.files},
          {"bytes", counts.bytes},       {"labels", counts.labels}};
}

Json free_form(const std::unique_ptr<nlohmann::json>& section) {
  return section ? Json(*section) : Json(nullptr);
}

Json unit_json(const std::string& unit) {
  const auto metres = metres_per(unit);
  return metres ? Json(*metres) : Json(nullptr);
}

const char* mode_name(LabelMode mode) {
  return mode == LabelMode::off ? "off" : mode == LabelMode::each ? "each" : "shared";
}

Json run_scene(const ServedFiles& files) {
  const fs::path& directory = files.path();
  const Manifest manifest = read_manifest(directory / manifest_name);
  const VolumeGeometry& frame = manifest.frame;
  const Vec3 last = as_vec3(frame.size) - Vec3{1, 1, 1};
  Json out = {{"format", "voxweld-scene"},
              {"version", 1},
              {"kind", "run"},
              {"name", files.name()},
              {"unit", frame.unit},
              {"metres_per_unit", unit_json(frame.unit)},
              {"frame", json_of(frame)},
              {"bounds", box_json(frame.first, place_of(frame, last))},
              {"border", manifest.open_border ? "open" : "closed"},
              {"labels_mode", mode_name(manifest.labels)},
              {"counts", json_of(manifest.counts)},
              {"error", free_form(manifest.error)},
              {"refine", free_form(manifest.refine)}};
  if (manifest.made_by && manifest.made_by->contains("time"))
    out["made"] = (*manifest.made_by)["time"];
  if (files.find(tileset_name)) out["tileset"] = tileset_name;
  if (files.find(report_name)) out["report"] = report_name;
  out["merged"] = Json::array();
  for (const FileRecord& file : manifest.files)
    if (file.role == "merged") out["merged"].push_back(json_of(file));
  out["labels"] = Json::array();
  if (manifest.labels != LabelMode::off) {
    LabelListReader labels(directory / labels_name);
    while (const auto label = labels.next()) out["labels"].push_back(json_of(*label));
  }
  out["tiles"] = Json::array();
  TileListReader tiles(directory / tiles_name);
  while (const auto tile = tiles.next())
    if (!tile->files.empty()) out["tiles"].push_back(json_of(*tile, frame));
  return out;
}

// What the page has readers for (page/src/formats.js), by a file's last ending.
constexpr std::array<std::string_view, 6> viewable_endings = {".drc", ".glb", ".ply",
                                                              ".stl", ".obj", ".vtp"};

Json file_scene(const ServedFiles& files) {
  const auto file = files.find(files.name());
  if (!file) throw InputError(files.path().string() + ": no such file");
  const MeshWriter* format = writer_of_file(mesh_writers(), files.name());
  return {{"format", "voxweld-scene"},
          {"version", 1},
          {"kind", "file"},
          {"name", files.name()},
          {"unit", ""},
          {"metres_per_unit", nullptr},
          {"labels_mode", "off"},
          {"file",
           {{"format", format == nullptr ? "" : format->name},
            {"path", files.name()},
            {"bytes", fs::file_size(*file)}}},
          {"labels", Json::array()},
          {"tiles", Json::array()},
          {"merged", Json::array()}};
}

}  // namespace

std::string scene_text(const ServedFiles& files) {
  return json_text(files.is_folder() ? run_scene(files) : file_scene(files));
}

void check_viewable(const ServedFiles& files) {
  if (files.find(exported_scene_name))
    throw InputError(
        files.path().string() +
        ": is a page that `voxweld view --export` has written; put it on a web server, "
        "or name the output directory that it was made from");
  if (files.is_folder()) return require_output(files.path());
  const std::string name = files.name();
  if (std::ranges::none_of(viewable_endings, [&](auto ending) { return name.ends_with(ending); }))
    throw InputError(
        fmt::format("{}: not a mesh file that can be shown; expected {}, or the output.directory "
                    "of a finished run",
                    files.path().string(), fmt::join(viewable_endings, ", ")));
}

}  // namespace voxweld
