#include "pipeline/mesh/manifest.h"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <nlohmann/json.hpp>

#include "storage/support/error.h"

namespace voxweld {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr const char* format_name = "voxweld-manifest";
constexpr int format_version = 2;

// A JSON value and where it stands, so that whatever is wrong with it is named.
class Value {
 public:
  Value(const json& value, std::string where, std::string key)
      : value_(value), where_(std::move(where)), key_(std::move(key)) {}

  [[noreturn]] void wrong(const std::string& expected) const {
    throw FormatError(fmt::format("{}: {} is {}, expected {}", where_,
                                  key_.empty() ? "the document" : "\"" + key_ + "\"",
                                  shortened(value_.dump()), expected));
  }
  bool has(const char* key) const { return value_.is_object() && value_.contains(key); }
  bool is_null() const { return value_.is_null(); }
  Value at(const char* key) const {
    if (!value_.is_object()) wrong("an object");
    const auto found = value_.find(key);
    if (found == value_.end())
      throw FormatError(fmt::format("{}: \"{}\" is missing", where_, joined(key)));
    return {*found, where_, joined(key)};
  }
  std::vector<Value> items() const {
    if (!value_.is_array()) wrong("an array");
    std::vector<Value> out;
    for (std::size_t i = 0; i < value_.size(); ++i)
      out.emplace_back(value_[i], where_, fmt::format("{}[{}]", key_, i));
    return out;
  }
  std::vector<Value> items(std::size_t count) const {
    if (!value_.is_array() || value_.size() != count) wrong(fmt::format("{} values", count));
    return items();
  }
  std::string text() const {
    if (!value_.is_string()) wrong("a text");
    return value_.get<std::string>();
  }
  bool choice(const std::string& no, const std::string& yes) const {
    const std::string found = text();
    if (found != no && found != yes) wrong(fmt::format("\"{}\" or \"{}\"", no, yes));
    return found == yes;
  }
  std::uint64_t count() const {
    if (!value_.is_number_unsigned()) wrong("a count");
    return value_.get<std::uint64_t>();
  }
  std::int64_t integer(std::int64_t lo, std::int64_t hi) const {
    if (!value_.is_number_integer() || value_ < lo || value_ > hi)
      wrong(fmt::format("an integer from {} to {}", lo, hi));
    return value_.get<std::int64_t>();
  }
  double real() const {
    if (!value_.is_number() || !std::isfinite(value_.get<double>())) wrong("a number");
    return value_.get<double>();
  }
  double positive() const {
    if (!(real() > 0)) wrong("a number above 0");
    return real();
  }
  Vec3 vector() const {
    const auto v = items(3);
    return {v[0].real(), v[1].real(), v[2].real()};
  }
  const json& raw() const { return value_; }

 private:
  static std::string shortened(std::string text) {
    return text.size() <= 60 ? text : text.substr(0, 57) + "...";
  }
  std::string joined(const std::string& key) const { return key_.empty() ? key : key_ + "." + key; }
  const json& value_;
  std::string where_, key_;
};

ordered_json to_json(Vec3 v) {
  return {v.x, v.y, v.z};
}
ordered_json to_json(Index3 v) {
  return {v.x, v.y, v.z};
}

ordered_json to_json(const FileRecord& file) {
  ordered_json out = {{"path", file.path}, {"format", file.format}};
  if (!file.role.empty()) out["role"] = file.role;
  out["bytes"] = file.bytes;
  out["xxh3_128"] = file.xxh3_128;
  return out;
}

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

ordered_json to_json(const ManifestCounts& c) {
  return {{"bricks", c.bricks},
          {"active_bricks", c.active_bricks},
          {"collapsed_above_bricks", c.collapsed_above},
          {"leaves", c.leaves},
          {"vertices", c.vertices},
          {"quads", c.quads},
          {"triangles", c.triangles},
          {"output_triangles", c.output_triangles},
          {"tiles", c.tiles},
          {"collinear", c.collinear},
          {"files", c.files},
          {"bytes", c.bytes}};
}

// Relative and inside the directory: a manifest must not send its reader elsewhere.
std::string relative_path(const Value& value) {
  const std::filesystem::path path = value.text();
  bool inside = !path.empty() && path.is_relative();
  for (const auto& part : path) inside = inside && part != "..";
  if (!inside) value.wrong("a path inside the output directory");
  return path.string();
}

FileRecord file_record(const Value& value, bool with_role) {
  FileRecord file;
  file.path = relative_path(value.at("path"));
  file.format = value.at("format").text();
  if (with_role) file.role = value.at("role").text();
  file.bytes = value.at("bytes").count();
  file.xxh3_128 = value.at("xxh3_128").text();
  return file;
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

ManifestCounts counts_of(const Value& value) {
  ManifestCounts c;
  c.bricks = value.at("bricks").count();
  c.active_bricks = value.at("active_bricks").count();
  c.collapsed_above = value.at("collapsed_above_bricks").count();
  for (const Value& level : value.at("leaves").items()) c.leaves.push_back(level.count());
  c.vertices = value.at("vertices").count();
  c.quads = value.at("quads").count();
  c.triangles = value.at("triangles").count();
  c.output_triangles = value.at("output_triangles").count();
  c.tiles = value.at("tiles").count();
  c.collinear = value.at("collinear").count();
  c.files = value.at("files").count();
  c.bytes = value.at("bytes").count();
  return c;
}

std::optional<MergedFiles> merged_of(const Value& value) {
  if (value.is_null()) return std::nullopt;
  MergedFiles merged;
  if (value.has("drc")) merged.drc = relative_path(value.at("drc"));
  if (value.has("glb")) merged.glb = relative_path(value.at("glb"));
  return merged;
}

std::unique_ptr<json> section(const Value& document, const char* key) {
  return document.has(key) ? std::make_unique<json>(document.at(key).raw()) : nullptr;
}

json parse_text(const std::string& text, const std::string& where) {
  try {
    return json::parse(text);
  } catch (const json::parse_error& e) {
    throw FormatError(fmt::format("{}: not JSON: error at byte {} of {}: truncated or damaged",
                                  where, e.byte, text.size()));
  }
}

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
  out["counts"] = to_json(manifest.counts);
  out["merged"] = nullptr;
  if (manifest.merged) {
    out["merged"] = ordered_json::object();
    if (!manifest.merged->drc.empty()) out["merged"]["drc"] = manifest.merged->drc;
    if (!manifest.merged->glb.empty()) out["merged"]["glb"] = manifest.merged->glb;
  }
  const std::pair<const char*, const json*> sections[] = {{"input", manifest.input.get()},
                                                          {"config", manifest.config.get()},
                                                          {"stages", manifest.stages.get()},
                                                          {"error", manifest.error.get()},
                                                          {"made_by", manifest.made_by.get()}};
  for (const auto& [key, value] : sections)
    if (value != nullptr) out[key] = *value;
  out["files"] = ordered_json::array();
  for (const FileRecord& file : manifest.files) out["files"].push_back(to_json(file));
  write_whole_file(path, as_bytes(out.dump(2) + "\n"), durability);
}

Manifest read_manifest(const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = read_whole_file(path);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const json parsed = parse_text(text, path.string());
  const Value document(parsed, path.string(), "");
  if (document.at("format").text() != format_name)
    document.at("format").wrong(fmt::format("\"{}\"", format_name));
  if (document.at("version").count() != format_version)
    document.at("version").wrong(fmt::format("{}", format_version));
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
  manifest.input = section(document, "input");
  manifest.config = section(document, "config");
  manifest.stages = section(document, "stages");
  manifest.error = section(document, "error");
  manifest.made_by = section(document, "made_by");
  return manifest;
}

std::string to_json_line(const TileRecord& record) {
  ordered_json out;
  out["tile"] = {{"level", record.tile.level}, {"at", to_json(record.tile.at)}};
  out["vertices"] = record.vertices;
  out["triangles"] = record.triangles;
  out["quads"] = record.quads;
  out["polygon_triangles"] = record.polygon_triangles;
  out["files"] = ordered_json::array();
  for (const FileRecord& file : record.files) out["files"].push_back(to_json(file));
  return out.dump() + "\n";
}

TileRecord parse_tile_record(const std::string& line, const std::string& where) {
  const json parsed = parse_text(line, where);
  const Value value(parsed, where, "");
  TileRecord record;
  const Value tile = value.at("tile");
  record.tile.level = static_cast<int>(tile.at("level").integer(0, max_levels));
  const auto at = tile.at("at").items(3);
  for (int axis = 0; axis < 3; ++axis)
    record.tile.at[axis] = at[static_cast<std::size_t>(axis)].integer(
        0, (std::int64_t{1} << (max_levels - record.tile.level)) - 1);
  record.vertices = value.at("vertices").count();
  record.triangles = value.at("triangles").count();
  record.quads = value.at("quads").count();
  record.polygon_triangles = value.at("polygon_triangles").count();
  for (const Value& file : value.at("files").items())
    record.files.push_back(file_record(file, false));
  return record;
}

TileListReader::TileListReader(const std::filesystem::path& path)
    : path_(path.string()), stream_(path) {
  if (!stream_) throw_errno("open", path_, errno);
}

std::optional<TileRecord> TileListReader::next() {
  std::string line;
  while (std::getline(stream_, line)) {
    ++line_;
    if (!line.empty()) return parse_tile_record(line, fmt::format("{} line {}", path_, line_));
  }
  if (stream_.bad()) throw StorageError(fmt::format("cannot read {}", path_));
  return std::nullopt;
}

}  // namespace voxweld
