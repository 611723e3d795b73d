// tiles.jsonl and labels.jsonl, and what they share with the manifest.
#include <fmt/format.h>

#include <cerrno>
#include "storage/support/json_text.h"

#include "storage/manifest/json_value.h"

namespace voxweld {

using nlohmann::ordered_json;

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

std::string relative_path(const JsonValue& value) {
  const std::filesystem::path path = value.text();
  bool inside = !path.empty() && path.is_relative();
  for (const auto& part : path) inside = inside && part != "..";
  if (!inside) value.wrong("a path inside the output directory");
  return path.string();
}

FileRecord file_record(const JsonValue& value, bool with_role) {
  FileRecord file;
  file.path = relative_path(value.at("path"));
  file.format = value.at("format").text();
  if (with_role) file.role = value.at("role").text();
  file.bytes = value.at("bytes").count();
  file.xxh3_128 = value.at("xxh3_128").text();
  return file;
}

nlohmann::json parse_text(const std::string& text, const std::string& where) {
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& e) {
    throw FormatError(fmt::format("{}: not JSON: error at byte {} of {}: truncated or damaged",
                                  where, e.byte, text.size()));
  } catch (const nlohmann::json::out_of_range&) {
    throw FormatError(where + ": not JSON: a number in it is too large: damaged");
  }
}

namespace {

ordered_json to_json(const CellKey& cell) {
  return {{"level", cell.level}, {"at", to_json(cell.at)}};
}

CellKey cell_of(const JsonValue& value) {
  CellKey cell;
  cell.level = static_cast<int>(value.at("level").integer(0, max_levels));
  const auto at = value.at("at").items(3);
  for (int axis = 0; axis < 3; ++axis)
    cell.at[axis] = at[static_cast<std::size_t>(axis)].integer(
        0, (std::int64_t{1} << (max_levels - cell.level)) - 1);
  return cell;
}

}  // namespace

std::string to_json_line(const TileRecord& record) {
  ordered_json out;
  if (record.label) out["label"] = *record.label;
  if (record.lod > 0) out["lod"] = record.lod;
  out["tile"] = to_json(record.tile);
  if (record.place) out["place"] = to_json(*record.place);
  out["vertices"] = record.vertices;
  out["triangles"] = record.triangles;
  out["quads"] = record.quads;
  out["polygon_triangles"] = record.polygon_triangles;
  out["files"] = ordered_json::array();
  for (const FileRecord& file : record.files) out["files"].push_back(to_json(file));
  return json_text(out) + "\n";
}

TileRecord parse_tile_record(const std::string& line, const std::string& where) {
  const nlohmann::json parsed = parse_text(line, where);
  const JsonValue value(parsed, where, "");
  TileRecord record;
  if (value.has("label")) record.label = value.at("label").count();
  if (value.has("lod")) record.lod = static_cast<int>(value.at("lod").integer(0, 255));
  record.tile = cell_of(value.at("tile"));
  if (value.has("place")) record.place = cell_of(value.at("place"));
  record.vertices = value.at("vertices").count();
  record.triangles = value.at("triangles").count();
  record.quads = value.at("quads").count();
  record.polygon_triangles = value.at("polygon_triangles").count();
  for (const JsonValue& file : value.at("files").items())
    record.files.push_back(file_record(file, false));
  return record;
}

std::string to_json_line(const LabelRecord& record) {
  ordered_json out;
  out["label"] = record.label;
  if (!record.name.empty()) out["name"] = record.name;
  if (record.color) out["color"] = *record.color;
  out["vertices"] = record.vertices;
  out["triangles"] = record.triangles;
  out["volume"] = nullptr;
  if (record.volume) out["volume"] = *record.volume;
  out["area"] = record.area;
  out["bounds"] = nullptr;
  if (record.bounds)
    out["bounds"] = ordered_json{to_json(record.bounds->lo), to_json(record.bounds->hi)};
  out["tiles"] = record.tiles;
  out["files"] = record.files;
  return json_text(out) + "\n";
}

LabelRecord parse_label_record(const std::string& line, const std::string& where) {
  const nlohmann::json parsed = parse_text(line, where);
  const JsonValue value(parsed, where, "");
  LabelRecord record;
  record.label = value.at("label").count();
  if (value.has("name")) record.name = value.at("name").text();
  if (value.has("color")) {
    const auto color = value.at("color").items(3);
    record.color.emplace();
    for (std::size_t i = 0; i < 3; ++i)
      (*record.color)[i] = static_cast<std::uint8_t>(color[i].integer(0, 255));
  }
  record.vertices = value.at("vertices").count();
  record.triangles = value.at("triangles").count();
  if (const JsonValue volume = value.at("volume"); !volume.is_null()) record.volume = volume.real();
  record.area = value.at("area").real();
  if (const JsonValue bounds = value.at("bounds"); !bounds.is_null()) {
    const auto corners = bounds.items(2);
    record.bounds = {corners[0].vector(), corners[1].vector()};
  }
  record.tiles = value.at("tiles").count();
  for (const JsonValue& file : value.at("files").items())
    record.files.push_back(relative_path(file));
  return record;
}

namespace {

template <class Record>
Record parsed(const std::string& line, const std::string& where) {
  if constexpr (std::is_same_v<Record, TileRecord>)
    return parse_tile_record(line, where);
  else
    return parse_label_record(line, where);
}

}  // namespace

template <class Record>
ListReader<Record>::ListReader(const std::filesystem::path& path)
    : path_(path.string()), stream_(path) {
  if (!stream_) throw_errno("open", path_, errno);
  // A device may never end.
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    throw FormatError(path_ + ": not a regular file");
}

template <class Record>
std::optional<Record> ListReader<Record>::next() {
  std::string line;
  while (std::getline(stream_, line)) {
    ++line_;
    if (!line.empty()) return parsed<Record>(line, fmt::format("{} line {}", path_, line_));
  }
  if (stream_.bad()) throw StorageError(fmt::format("cannot read {}", path_));
  return std::nullopt;
}

template class ListReader<TileRecord>;
template class ListReader<LabelRecord>;

}  // namespace voxweld
