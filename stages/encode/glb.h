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
  Material label = exterior;  // whose surface the mesh is, if of any: named for it
};

// The file holds `mesh.bytes` as it is, one node, one mesh, one primitive of mode TRIANGLES with
// uncompressed accessors left out, in the colour of its label where it has one. Positions stay in
// the mesh's frame and unit, so tiles agree to the bit. The same input gives the same bytes.
// InputError past 4 GiB, the format's limit.
// pairs: of a mesh of encode_draco_features. The file has them as a table, which the points' feature
// ids number (glb_pairs.h).
std::vector<std::byte> wrap_glb(const EncodedMesh& mesh, const GlbParameters& parameters,
                                std::span<const MaterialPair> pairs = {});

// The same with all that the accessors say as it is: positions and normals as floats, corners in 32
// bits. Programs that know no extension open it. Of a mesh between labels no point has two pairs.
// Precondition: there are triangles.
void write_plain_glb(const DecodedMesh& mesh, const GlbParameters& parameters,
                     const ByteSink& sink);

// The mesh of a .glb of the kinds above and of write_meshopt_glb: its Draco buffer decoded or its
// accessors read, and the accessors' counts, minima and maxima compared with that. FormatError, starting with `where`, for
// anything else.
DecodedMesh decode_glb(std::span<const std::byte> glb, const std::string& where = "glTF binary");

// Where what lies at a point of the files lies in the world: column-major, metres, z up. Axes that are
// not at right angles are left out, as in the files.
std::array<double, 16> world_matrix(const VolumeGeometry& frame);

// Metres in one `unit` ("mm", "micrometer" ...), nothing where it is not known.
std::optional<double> metres_per(const std::string& unit);

}  // namespace voxweld
