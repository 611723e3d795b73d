// glTF 2.0 binaries, around Draco buffers (KHR_draco_mesh_compression) or plain, and back.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stages/encode/byte_sink.h"
#include "stages/encode/draco_codec.h"
#include "storage/types/material_table.h"
#include "storage/types/volume.h"

namespace voxweld {

struct GlbParameters {
  // Where the mesh's axis-aligned frame lies in the world, applied as the node's transform: origin
  // and direction, the unit scaled to glTF's metre (an unknown or empty unit is left as it is).
  // Directions that are not orthogonal have no place in a glTF node: then they are left out and
  // stated in the node's extras.
  std::optional<VolumeGeometry> frame = std::nullopt;
  bool y_up = true;  // turn z-up data to glTF's y-up: (x, y, z) -> (x, z, -y)
  // Colours of labels, where they have one; null: none has.
  const MaterialTable* materials = nullptr;
  Material label = exterior;  // whose surface a mesh of one part is, if of any
};

// A primitive of a mesh between labels: its triangles separate `pair`.
struct GlbPart {
  EncodedMesh mesh;
  MaterialPair pair;
};

// The file holds `mesh.bytes` as it is, one node, one mesh, one primitive of mode TRIANGLES with
// uncompressed accessors left out, in the colour of its label where it has one. Positions stay in
// the mesh's frame and unit, so tiles agree to the bit. The same input gives the same bytes.
// InputError past 4 GiB, the format's limit.
std::vector<std::byte> wrap_glb(const EncodedMesh& mesh, const GlbParameters& parameters);

// The same with a primitive for each part, each with a material of its own: named for its labels
// ("7 | 12", "7 | outside"), visible from both sides, of the colour that `inside` has, or one that
// tells it from others.
// The primitive's extras have "inside" and "outside" (null: outside all labels).
// Precondition: at least one part.
std::vector<std::byte> wrap_glb(std::span<const GlbPart> parts, const GlbParameters& parameters);

// A primitive without compression, or the only one. pair: of a mesh between labels.
struct PlainGlbPart {
  DecodedMesh mesh;
  std::optional<MaterialPair> pair = std::nullopt;
};

// The same with all that the accessors say as it is: positions and normals as floats, corners in 32
// bits. Programs that know no extension open it. Precondition: at least one part, each with triangles.
void write_plain_glb(std::span<const PlainGlbPart> parts, const GlbParameters& parameters,
                     const ByteSink& sink);

// The mesh of a .glb of the kinds above: its Draco buffers decoded or its accessors read, and the
// accessors' counts, minima and maxima compared with that. Primitives with labels in their extras are put
// together, one after another. FormatError, starting with `where`, for anything else.
DecodedMesh decode_glb(std::span<const std::byte> glb, const std::string& where = "glTF binary");

// Where what lies at a point of the files lies in the world: column-major, metres, z up. Axes that are
// not at right angles are left out, as in the files.
std::array<double, 16> world_matrix(const VolumeGeometry& frame);

// Metres in one `unit` ("mm", "micrometer" ...), nothing where it is not known.
std::optional<double> metres_per(const std::string& unit);

}  // namespace voxweld
