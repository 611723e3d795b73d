// The formats that meshes are written in: one table, from which encode, its lists, verify, whoever
// loads a mesh and the setting output.formats take all they know of a format.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stages/encode/draco_codec.h"
#include "stages/encode/mesh_streams.h"
#include "storage/types/material_table.h"
#include "storage/types/volume.h"

namespace voxweld {

// What a format may put into a file beyond the mesh.
struct AssetFacts {
  EncodeParameters encoding;
  std::optional<VolumeGeometry> frame = std::nullopt;  // where the mesh lies in the world
  const MaterialTable* materials = nullptr;  // names and colours of labels; null: none has one
  Material label = exterior;                 // whose surface the mesh is, if of any
};

// One mesh on its way into several formats, which share what is costly to make.
class Asset {
 public:
  // Keeps both references.
  Asset(const TileMesh& mesh, const AssetFacts& facts) : mesh_(mesh), facts_(facts) {}
  Asset(const TileMesh&&, const AssetFacts&) = delete;
  Asset(const TileMesh&, const AssetFacts&&) = delete;

  const TileMesh& mesh() const { return mesh_; }
  const AssetFacts& facts() const { return facts_; }
  // Of the whole mesh: encoded when first asked for.
  const EncodedMesh& encoded();

 private:
  const TileMesh& mesh_;
  const AssetFacts& facts_;
  std::optional<EncodedMesh> encoded_;
};

struct MeshWriter {
  std::string_view name;  // in output.formats, in the manifest and the lists
  std::string_view
      ending;  // of its files, with the dot; may end as another's does: the longer counts
  bool describes = false;  // a file depends on the names and colours that labels are given
  // Between labels: memory that each pair of labels takes while its mesh is written.
  std::uint64_t pair_bytes = 0;
  // The same asset gives the same bytes. Errors as encode_draco's, and InputError for a mesh that
  // the format cannot hold.
  void (*write)(Asset& asset, const ByteSink& sink) = nullptr;
  // FormatError, starting with `where`, for what is no whole file of the format. The coordinates
  // are those that were written, to the bit.
  DecodedMesh (*read)(std::span<const std::byte> file, const std::string& where) = nullptr;
  // The same file from the mesh's tiles, without holding the mesh. Null: the format needs all of it.
  void (*stream)(const EachTile& each_tile, const StreamTotals& totals,
                 const ByteSink& sink) = nullptr;
  bool is_streamed() const { return stream != nullptr; }
  // Of a mesh between labels a file says which labels each triangle separates.
  bool holds_labels = true;
};
using MeshWriters = std::span<const MeshWriter>;

// Whose files are the contents of a tileset of 3D Tiles, which are glTF: the first of these that is there.
inline constexpr std::array<std::string_view, 3> tileset_formats{"glb", "meshopt", "glb-plain"};

// In the order in which the files of a mesh are written and listed.
MeshWriters mesh_writers();

// Null where the table has none.
const MeshWriter* writer_named(MeshWriters writers, std::string_view name);
// Of a file of this name: the one with the longest ending that the name has.
const MeshWriter* writer_of_file(MeshWriters writers, std::string_view file);
// Those of the names, in the table's order. Precondition: it has them.
std::vector<MeshWriter> writers_named(MeshWriters writers, std::span<const std::string> names);
// For messages: ".drc or .glb".
std::string endings_text(MeshWriters writers, std::string_view last_joint = " or ");

}  // namespace voxweld
