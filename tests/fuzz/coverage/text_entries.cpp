// Configs, label maps, manifests and meshes.
#include <stdexcept>

#include "pipeline/config/config.h"
#include "stages/encode/draco_codec.h"
#include "stages/encode/glb.h"
#include "stages/encode/vtp.h"
#include "storage/labels/label_map.h"
#include "storage/manifest/manifest.h"
#include "storage/manifest/task_report.h"
#include "storage/meshes/mesh_file.h"
#include "tests/fuzz/coverage/entries.h"

namespace voxweld::testing {
namespace {

std::string text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// What is accepted can be written, and reads back as the same.
void parse_config_text(const ParserEntry&, Bytes bytes) {
  const std::filesystem::path path = "/nowhere/case.toml";
  const Config config = parse_config(text_of(bytes), path);
  const std::string canonical = canonical_toml(config);
  if (parse_config(canonical, path) != config)
    throw std::logic_error("a config is another once written:\n" + canonical);
}

void parse_labels(const ParserEntry& entry, Bytes bytes) {
  parse_label_map(text_of(bytes), std::filesystem::path("map").replace_extension(entry.ending));
}

void parse_manifest(const ParserEntry& entry, Bytes bytes) {
  read_manifest(write_case(bytes, entry.ending));
}

template <class Reader>
void parse_list(const ParserEntry& entry, Bytes bytes) {
  Reader reader(write_case(bytes, entry.ending));
  while (reader.next()) {
  }
}

void parse_task_report(const ParserEntry& entry, Bytes bytes) {
  read_task_report(write_case(bytes, entry.ending));
}

void parse_mesh(const ParserEntry& entry, Bytes bytes) {
  const MeshFile file = read_mesh_file(write_case(bytes, entry.ending));
  for (const auto& triangle : file.mesh.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= file.mesh.vertices.size())
        throw std::logic_error("a triangle has a corner that is not there");
}

void check_decoded(const DecodedMesh& mesh) {
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= mesh.positions.size())
        throw std::logic_error("a triangle has a corner that is not there");
}
void parse_draco(const ParserEntry&, Bytes bytes) {
  check_decoded(decode_draco(bytes));
}
void parse_glb(const ParserEntry&, Bytes bytes) {
  check_decoded(decode_glb(bytes));
}
void parse_vtp(const ParserEntry&, Bytes bytes) {
  check_decoded(decode_vtp(bytes, "file"));
}

}  // namespace

std::vector<ParserEntry> text_entries() {
  return {{"config", ".toml", "", "", parse_config_text},
          {"labels-csv", ".csv", "", "", parse_labels},
          {"labels-json", ".json", "", "", parse_labels},
          {"labels-ctbl", ".ctbl", "", "", parse_labels},
          {"labels-txt", ".txt", "", "", parse_labels},
          {"manifest", ".json", "", "", parse_manifest},
          {"tiles-list", ".jsonl", "", "", parse_list<TileListReader>},
          {"labels-list", ".jsonl", "", "", parse_list<LabelListReader>},
          {"task-report", ".json", "", "", parse_task_report},
          {"off", ".off", "", "", parse_mesh},
          {"obj", ".obj", "", "", parse_mesh},
          {"ply", ".ply", "", "", parse_mesh},
          {"stl", ".stl", "", "", parse_mesh},
          {"draco", ".drc", "", "", parse_draco},
          {"glb", ".glb", "", "", parse_glb},
          {"vtp", ".vtp", "", "", parse_vtp}};
}

}  // namespace voxweld::testing
