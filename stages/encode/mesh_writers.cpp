#include "stages/encode/mesh_writers.h"

#include <algorithm>
#include <array>

#include "stages/encode/corner_points.h"
#include "stages/encode/glb.h"
#include "stages/encode/glb_meshopt.h"
#include "stages/encode/glb_pairs.h"
#include "stages/encode/vtp.h"

namespace voxweld {
namespace {

void write_drc(Asset& asset, const ByteSink& sink) {
  sink(asset.encoded().bytes);
}

GlbParameters glb_parameters(const AssetFacts& facts) {
  GlbParameters parameters;
  parameters.frame = facts.frame;
  parameters.materials = facts.materials;
  parameters.label = facts.label;
  return parameters;
}

void write_glb(Asset& asset, const ByteSink& sink) {
  const TileMesh& mesh = asset.mesh();
  const AssetFacts& facts = asset.facts();
  const GlbParameters parameters = glb_parameters(facts);
  if (mesh.pairs.empty()) return sink(wrap_glb(asset.encoded(), parameters));
  const auto colours = glb::pair_colours(mesh.pairs, facts.materials);
  const EncodedMesh encoded = encode_draco_features(mesh, facts.encoding, colours);
  sink(wrap_glb(encoded, parameters, mesh.pairs));
}

void write_plain(Asset& asset, const ByteSink& sink) {
  write_plain_glb(corner_points(asset.mesh(), asset.facts().encoding.normals),
                  glb_parameters(asset.facts()), sink);
}

void write_meshopt(Asset& asset, const ByteSink& sink) {
  write_meshopt_glb(corner_points(asset.mesh(), asset.facts().encoding.normals),
                    asset.mesh().lattice, glb_parameters(asset.facts()), sink);
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

// A row of the table of a .glb and its colours, with names of fifty letters on both sides.
constexpr std::uint64_t glb_pair = 512;

constexpr std::array<MeshWriter, 8> table{{
    {"drc", ".drc", false, 256, write_drc, decode_draco},
    {"glb", ".glb", true, glb_pair, write_glb, decode_glb},
    {"glb-plain", ".plain.glb", true, glb_pair, write_plain, decode_glb},
    {"meshopt", ".meshopt.glb", true, glb_pair, write_meshopt, decode_glb},
    {"ply", ".ply", false, 64, write_streamed<stream_ply>, read_ply, stream_ply},
    {"stl", ".stl", false, 0, write_streamed<stream_stl>, read_stl, stream_stl, false},
    {"obj", ".obj", false, 0, write_streamed<stream_obj>, read_obj, stream_obj, false},
    {"vtp", ".vtp", false, 64, write_streamed<stream_vtp>, decode_vtp, stream_vtp},
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
