#include "stages/encode/mesh_writers.h"

#include <algorithm>
#include <array>

#include "stages/encode/corner_points.h"
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

GlbParameters glb_parameters(const AssetFacts& facts) {
  GlbParameters parameters;
  parameters.frame = facts.frame;
  parameters.materials = facts.materials;
  parameters.label = facts.label;
  return parameters;
}

void write_glb(Asset& asset, const ByteSink& sink) {
  const GlbParameters parameters = glb_parameters(asset.facts());
  sink(asset.mesh().pairs.empty() ? wrap_glb(asset.encoded(), parameters)
                                  : glb_by_pair(asset, parameters));
}

void write_plain(Asset& asset, const ByteSink& sink) {
  const TileMesh& mesh = asset.mesh();
  const bool normals = asset.facts().encoding.normals;
  std::vector<PlainGlbPart> parts;
  if (mesh.pairs.empty()) {
    parts.push_back({corner_points(mesh, normals)});
  } else {
    const std::vector<TileMesh> meshes = split_by_pair(mesh);
    for (std::size_t i = 0; i < meshes.size(); ++i)
      parts.push_back({corner_points(meshes[i], normals), mesh.pairs[i]});
  }
  write_plain_glb(parts, glb_parameters(asset.facts()), sink);
}

// A mesh that is there as a whole, as the one tile of a stream.
template <void (*stream)(const EachTile&, const StreamTotals&, const ByteSink&)>
void write_streamed(Asset& asset, const ByteSink& sink) {
  const EachTile each_tile = [&](const auto& f) { f(asset.mesh()); };
  stream(each_tile, totals_of(each_tile), sink);
}

DecodedMesh read_ply(std::span<const std::byte> file, const std::string& where) {
  return decode_mesh_file(file, "ply", where);
}
DecodedMesh read_stl(std::span<const std::byte> file, const std::string& where) {
  return decode_mesh_file(file, "stl", where);
}
DecodedMesh read_obj(std::span<const std::byte> file, const std::string& where) {
  return decode_mesh_file(file, "obj", where);
}

// Of .glb a pair is a mesh of its own, encoded apart and described in JSON. On noise, where each
// polygon has a pair of its own, it took 8.6 KiB.
constexpr std::uint64_t glb_pair = 12288;

constexpr std::array<MeshWriter, 6> table{{
    {"drc", ".drc", false, 256, write_drc, decode_draco},
    {"glb", ".glb", true, glb_pair, write_glb, decode_glb},
    {"glb-plain", ".plain.glb", true, glb_pair, write_plain, decode_glb},
    {"ply", ".ply", false, 64, write_streamed<stream_ply>, read_ply, stream_ply},
    {"stl", ".stl", false, 0, write_streamed<stream_stl>, read_stl, stream_stl, false},
    {"obj", ".obj", false, 0, write_streamed<stream_obj>, read_obj, stream_obj, false},
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

const MeshWriter* writer_of_file(MeshWriters writers, std::string_view file) {
  const MeshWriter* longest = nullptr;
  for (const MeshWriter& writer : writers)
    if (file.ends_with(writer.ending) &&
        (longest == nullptr || writer.ending.size() > longest->ending.size()))
      longest = &writer;
  return longest;
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
