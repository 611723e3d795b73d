#include "stages/encode/mesh_writers.h"

#include <algorithm>
#include <array>

#include "stages/encode/glb.h"
#include "stages/encode/pair_meshes.h"

namespace voxweld {
namespace {

void write_drc(Asset& asset, const ByteSink& sink) {
  sink(asset.encoded().bytes);
}

// A primitive, and so a Draco buffer, for each pair of labels.
std::vector<std::byte> glb_by_pair(const Asset& asset, const GlbParameters& parameters) {
  const TileMesh& mesh = asset.mesh();
  const std::vector<TileMesh> meshes = split_by_pair(mesh);
  std::vector<GlbPart> parts;
  for (std::size_t i = 0; i < meshes.size(); ++i)
    parts.push_back({encode_draco(meshes[i], asset.facts().encoding), mesh.pairs[i]});
  return wrap_glb(parts, parameters);
}

void write_glb(Asset& asset, const ByteSink& sink) {
  GlbParameters parameters;
  parameters.frame = asset.facts().frame;
  parameters.materials = asset.facts().materials;
  parameters.label = asset.facts().label;
  sink(asset.mesh().pairs.empty() ? wrap_glb(asset.encoded(), parameters)
                                  : glb_by_pair(asset, parameters));
}

// Of .glb a pair is a mesh of its own, encoded apart and described in JSON. On noise, where each
// polygon has a pair of its own, it took 8.6 KiB.
constexpr std::array<MeshWriter, 2> table{{
    {"drc", ".drc", false, 256, write_drc, decode_draco},
    {"glb", ".glb", true, 12 * 1024, write_glb, decode_glb},
}};

}  // namespace

const EncodedMesh& Asset::encoded() {
  if (!encoded_) encoded_ = encode_draco(mesh_, facts_.encoding);
  return *encoded_;
}

MeshWriters mesh_writers() {
  return table;
}

const MeshWriter* writer_named(MeshWriters writers, std::string_view name) {
  const auto found = std::ranges::find(writers, name, &MeshWriter::name);
  return found == writers.end() ? nullptr : &*found;
}

const MeshWriter* writer_of_ending(MeshWriters writers, std::string_view ending) {
  const auto found = std::ranges::find(writers, ending, &MeshWriter::ending);
  return found == writers.end() ? nullptr : &*found;
}

std::vector<MeshWriter> writers_named(MeshWriters writers, std::span<const std::string> names) {
  std::vector<MeshWriter> chosen;
  for (const MeshWriter& writer : writers)
    if (std::ranges::find(names, writer.name) != names.end()) chosen.push_back(writer);
  return chosen;
}

std::string endings_text(MeshWriters writers, std::string_view last_joint) {
  std::string text;
  for (std::size_t i = 0; i < writers.size(); ++i) {
    if (i > 0) text += i + 1 == writers.size() ? last_joint : ", ";
    text += writers[i].ending;
  }
  return text;
}

}  // namespace voxweld
