#include "storage/manifest/manifest.h"

#include <fmt/format.h>

#include "storage/manifest/json_value.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;
using Value = JsonValue;

constexpr const char* format_name = "voxweld-manifest";
constexpr int format_version = 3;

ordered_json to_json(const VolumeGeometry& frame) {
  ordered_json direction = ordered_json::array();
  for (const Vec3& d : frame.direction) direction.push_back(to_json(d));
  return {{"size", to_json(frame.size)},
          {"spacing", to_json(frame.spacing)},
          {"unit", frame.unit},
          {"first", to_json(frame.first)},
          {"origin", to_json(frame.origin)},
          {"direction", std::move(direction)},
          {"space", frame.space}};
}

// f(key, figure) of each, in the order of the file.
template <class Counts, class F>
void each_count(Counts& c, const F& f) {
  f("bricks", c.bricks);
  f("active_bricks", c.active_bricks);
  f("collapsed_above_bricks", c.collapsed_above);
  f("leaves", c.leaves);
  f("vertices", c.vertices);
  f("quads", c.quads);
  f("polygon_triangles", c.polygon_triangles);
  f("triangles", c.triangles);
  f("tiles", c.tiles);
  f("collinear", c.collinear);
  f("files", c.files);
  f("bytes", c.bytes);
}

ordered_json to_json(const ManifestCounts& c, bool labels) {
  ordered_json out;
  each_count(c, [&](const char* key, const auto& figure) { out[key] = figure; });
  if (labels) out["labels"] = c.labels;
  return out;
}

OutputLattice lattice_of(const Value& value) {
  OutputLattice lattice;
  lattice.step = value.at("step").positive();
  lattice.bits = static_cast<int>(value.at("bits").integer(1, max_lattice_bits));
  const Vec3 origin = value.at("origin").vector();
  lattice.origin = {origin.x, origin.y, origin.z};
  return lattice;
}

VolumeGeometry frame_of(const Value& value) {
  VolumeGeometry frame;
  const auto size = value.at("size").items(3), spacing = value.at("spacing").items(3);
  const auto direction = value.at("direction").items(3);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int a = static_cast<int>(axis);
    frame.size[a] = size[axis].integer(1, std::int64_t{1} << 40);
    frame.spacing[a] = spacing[axis].positive();
    frame.direction[axis] = direction[axis].vector();
  }
  if (value.has("first")) frame.first = value.at("first").vector();
  frame.origin = value.at("origin").vector();
  frame.unit = value.at("unit").text();
  if (value.has("space")) frame.space = value.at("space").text();
  return frame;
}

void read_count(const Value& value, std::uint64_t& figure) {
  figure = value.count();
}
void read_count(const Value& value, std::vector<std::uint64_t>& levels) {
  for (const Value& level : value.items()) levels.push_back(level.count());
}

ManifestCounts counts_of(const Value& value) {
  ManifestCounts c;
  each_count(c, [&](const char* key, auto& figure) { read_count(value.at(key), figure); });
  if (value.has("labels")) c.labels = value.at("labels").count();
  return c;
}

std::optional<MergedFiles> merged_of(const Value& value) {
  if (value.is_null()) return std::nullopt;
  MergedFiles merged;
  for (const std::string& format : value.keys())
    merged.emplace(format, relative_path(value.at(format.c_str())));
  return merged;
}

// Free-form.
constexpr std::pair<const char*, std::unique_ptr<json> Manifest::*> sections[] = {
    {"input", &Manifest::input},    {"config", &Manifest::config}, {"stages", &Manifest::stages},
    {"error", &Manifest::error},    {"refine", &Manifest::refine}, {"levels", &Manifest::levels},
    {"made_by", &Manifest::made_by}};

}  // namespace

Manifest::Manifest() = default;
Manifest::~Manifest() = default;
Manifest::Manifest(Manifest&&) noexcept = default;
Manifest& Manifest::operator=(Manifest&&) noexcept = default;

void write_manifest(const Manifest& manifest, const std::filesystem::path& path,
                    Durability durability) {
  ordered_json out = {{"format", format_name}, {"version", format_version}};
  const OutputLattice& lattice = manifest.lattice;
  out["lattice"] = {{"step", lattice.step}, {"bits", lattice.bits}, {"origin", lattice.origin}};
  out["border"] = manifest.open_border ? "open" : "closed";
  if (manifest.border_slack > 0) out["border_slack"] = manifest.border_slack;
  out["topology"] = manifest.free_topology ? "free" : "safe";
  if (manifest.labels != LabelMode::off)
    out["labels"] = manifest.labels == LabelMode::each ? "each" : "shared";
  out["frame"] = to_json(manifest.frame);
  out["counts"] = to_json(manifest.counts, manifest.labels != LabelMode::off);
  out["merged"] = nullptr;
  if (manifest.merged) {
    out["merged"] = ordered_json::object();
    for (const auto& [format, file] : *manifest.merged) out["merged"][format] = file;
  }
  for (const auto& [key, section] : sections)
    if (manifest.*section != nullptr) out[key] = *(manifest.*section);
  out["files"] = ordered_json::array();
  for (const FileRecord& file : manifest.files) out["files"].push_back(to_json(file));
  write_whole_file(path, as_bytes(json_text(out, 2) + "\n"), durability);
}

Manifest read_manifest(const std::filesystem::path& path) {
  const json parsed = parse_text(read_text_file(path), path.string());
  const Value document(parsed, path.string(), "");
  if (document.at("format").text() != format_name)
    document.at("format").wrong(fmt::format("\"{}\"", format_name));
  if (document.at("version").count() != format_version)
    document.at("version").wrong(
        fmt::format("{}, as this voxweld writes it (make the mesh anew)", format_version));
  Manifest manifest;
  manifest.lattice = lattice_of(document.at("lattice"));
  manifest.open_border = document.at("border").choice("closed", "open");
  if (document.has("border_slack")) manifest.border_slack = document.at("border_slack").real();
  manifest.free_topology = document.at("topology").choice("safe", "free");
  if (document.has("labels"))
    manifest.labels =
        document.at("labels").choice("each", "shared") ? LabelMode::shared : LabelMode::each;
  manifest.frame = frame_of(document.at("frame"));
  manifest.counts = counts_of(document.at("counts"));
  manifest.merged = merged_of(document.at("merged"));
  for (const Value& file : document.at("files").items())
    manifest.files.push_back(file_record(file, true));
  for (const auto& [key, section] : sections)
    if (document.has(key)) manifest.*section = std::make_unique<json>(document.at(key).raw());
  return manifest;
}

}  // namespace voxweld
