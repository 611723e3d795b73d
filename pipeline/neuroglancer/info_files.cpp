#include "pipeline/neuroglancer/info_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "pipeline/neuroglancer/folder.h"
#include "pipeline/neuroglancer/world.h"
#include "stages/encode/fragment_cut.h"
#include "storage/support/file_io.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

using Json = nlohmann::ordered_json;

// Clients show a level where its scale, which is the side of its triangles, times this is less than a
// pixel, unless they are told otherwise: so where sides are less than four pixels. Its tolerance is less
// than one then: of the gyroid (512^3) 0.27 and 0.5 at the first two coarser levels.
constexpr double lod_scale_multiplier = 0.25;

void write_json(const Json& json, const std::filesystem::path& path) {
  const std::string text = json_text(json) + "\n";
  write_whole_file(path, as_bytes(text), Durability::fsync);
}

template <class Value>
Json values_of(const SegmentList& list, Value value) {
  Json values = Json::array();
  for (const Segment& segment : list.segments) values.push_back(value(segment));
  return values;
}

Json number(const std::string& id, const char* type, const std::string& description, Json values) {
  return {{"id", id},
          {"type", "number"},
          {"data_type", type},
          {"description", description},
          {"values", std::move(values)}};
}

}  // namespace

void write_segment_properties(const SegmentList& list, const Manifest& manifest,
                              const std::filesystem::path& folder) {
  const std::string unit = manifest.frame.unit.empty() ? "unit" : manifest.frame.unit;
  const auto all = [&](const auto& has) { return std::ranges::all_of(list.segments, has); };
  Json properties = Json::array();
  if (std::ranges::any_of(list.segments, [](const Segment& s) { return !s.name.empty(); }))
    properties.push_back({{"id", "label"},
                          {"type", "label"},
                          {"values", values_of(list, [](const Segment& s) { return s.name; })}});
  properties.push_back(
      number("triangles", "uint32", "of the finest level", values_of(list, [](const Segment& s) {
               constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
               return std::min(s.triangles, most);
             })));
  if (all([](const Segment& s) { return s.volume.has_value(); }))
    properties.push_back(number("volume", "float32", unit + "^3",
                                values_of(list, [](const Segment& s) { return *s.volume; })));
  if (all([](const Segment& s) { return s.area.has_value(); }))
    properties.push_back(number("area", "float32", unit + "^2",
                                values_of(list, [](const Segment& s) { return *s.area; })));
  const Json info = {
      {"@type", "neuroglancer_segment_properties"},
      {"inline",
       {{"ids", values_of(list, [](const Segment& s) { return fmt::to_string(s.id); })},
        {"properties", properties}}}};
  write_json(info, folder / segment_properties_name / info_name);
}

void write_info(const InfoFacts& facts, const VolumeGeometry& frame,
                const std::filesystem::path& folder) {
  Json info;
  info["@type"] = facts.legacy ? "neuroglancer_legacy_mesh" : "neuroglancer_multilod_draco";
  if (!facts.legacy) {
    info["vertex_quantization_bits"] = fragment_bits;
    info["transform"] = nanometre_matrix(frame);
    info["lod_scale_multiplier"] = lod_scale_multiplier;
  }
  if (facts.sharding)
    info["sharding"] = {{"@type", "neuroglancer_uint64_sharded_v1"},
                        {"preshift_bits", 0},
                        {"hash", "identity"},
                        {"minishard_bits", facts.sharding->minishard_bits},
                        {"shard_bits", facts.sharding->shard_bits},
                        {"minishard_index_encoding", "raw"},
                        {"data_encoding", "raw"}};
  info["segment_properties"] = segment_properties_name;
  // Clients do not read these.
  info["border"] = facts.open_border ? "open" : "closed";
  info["generator"] = "voxweld " VOXWELD_VERSION;
  write_json(info, folder / info_name);
}

}  // namespace voxweld
