// Tile meshes to Draco buffers and back. The only place that knows Draco.
//
// Positions are quantized on the run's output lattice, not on the mesh's own bounding box, so every
// file decodes a shared vertex to the same bits: exactly origin + q * step (DESIGN: the output
// lattice). Normals that change at a feature are attribute seams on the connectivity of the positions,
// where many do. Where few do, one vertex is encoded for each normal, which is quicker to decode.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "storage/types/tile_mesh.h"

namespace voxweld {

struct EncodeParameters {
  bool normals = true;
  int normal_bits = 10;  // 2..30, of each octahedral coordinate
  // Draco's speeds, 0 (small) .. 10 (fast). For a torus of 1.0 M triangles at 20 bits with normals,
  // bytes a triangle, seconds to encode and to decode: 0: 0.63, 1.8, 0.79; 4: 0.87, 0.84, 0.50;
  // 5: 1.13, 0.89, 0.47; 8: 2.38, 0.73, 0.48; 10 (no edgebreaker): 11.1, 0.27, 0.14. So 4 is as
  // fast as any edgebreaker and a quarter smaller than 5. 3 predicts normals from positions: simplified
  // meshes are 14 to 15 % smaller than with 4 (gyroid and part, 256^3), and take no more time to encode,
  // but 1.3 times as long to decode, in WebAssembly 1.55.
  int encode_speed = 3;
  int decode_speed = 3;
};

// A Draco buffer and what a container around it has to state, in the decoder's terms: Draco
// reorders points, drops unused ones and splits those at seams and bow-ties.
struct EncodedMesh {
  std::vector<std::byte> bytes;
  std::uint64_t points = 0;
  std::uint64_t triangles = 0;
  std::array<float, 3> lo{}, hi{};  // of the decoded positions, output units
  int position_id = 0;              // Draco unique ids
  int normal_id = -1;               // -1: no normals
  int pair_id = -1;                 // -1: not between labels
  int colour_id = -1;
};

// Red, green, blue (linear) and opacity of the points that one pair of labels has.
using PairColour = std::array<std::uint8_t, 4>;

// How glTF numbers pairs: vertices have no integers of 32 bits there. Floats are whole numbers.
enum class FeatureIdType : std::uint8_t { u8, u16, f32 };
constexpr FeatureIdType feature_id_type(std::size_t pairs) {
  return pairs <= 1u << 8    ? FeatureIdType::u8
         : pairs <= 1u << 16 ? FeatureIdType::u16
                             : FeatureIdType::f32;
}
// Draco rounds floats by adding a half, which keeps whole numbers below this.
inline constexpr int feature_id_bits = 23;

// A mesh between labels (labels.mode = "shared") has one more attribute: which pair of labels each
// triangle separates. Its edges and vertices of more than two sheets Draco splits; welding on exact
// coordinates joins them again.
// Preconditions: at least one triangle, coordinates in [0, 2^bits), bits <= max_lattice_bits, no
// triangle with two equal corners (Draco would drop it); with normals, mesh.normals and
// mesh.corner_normals are filled. InputError for what is outside these. The same mesh gives the
// same bytes.
EncodedMesh encode_draco(const TileMesh& mesh, const EncodeParameters& parameters);

// The same for glTF: pairs are numbers of feature_id_type without a list, and points have the colour of
// their pair, one each. Precondition: a mesh between labels. InputError past 2^feature_id_bits pairs.
EncodedMesh encode_draco_features(const TileMesh& mesh, const EncodeParameters& parameters,
                                  const std::vector<PairColour>& colours);

// Upper bound of the memory encode_draco takes beyond the mesh it is given, for meshes that are
// surfaces (about two triangles a vertex). between_labels: of encode_draco_features too, but for what
// pairs take (MeshWriter::pair_bytes).
std::uint64_t encode_memory_bytes(std::uint64_t vertices, std::uint64_t triangles, bool normals,
                                  bool between_labels = false);

struct DecodedMesh {
  std::vector<std::array<float, 3>> positions;  // output units, one a point
  std::vector<std::array<float, 3>> normals;    // unit, one a point; empty when there are none
  std::vector<std::array<std::uint32_t, 3>> triangles;
  // Of meshes between labels: the pairs there are, and each triangle's place in that list.
  std::vector<MaterialPair> pairs;
  std::vector<std::uint32_t> triangle_pairs;
  int position_id = 0;  // Draco unique ids
  int normal_id = -1;
  int pair_id = -1;
};

// FormatError, starting with `where` (a path), for anything that is not a whole Draco mesh with
// three float coordinates a point. A flipped bit may well decode: files carry hashes for that.
DecodedMesh decode_draco(std::span<const std::byte> bytes, const std::string& where = "Draco mesh");

// What the feature ids of a glTF number, and the unique id of Draco's attribute that has them.
struct PairList {
  int id = -1;
  std::vector<MaterialPair> pairs;
};
DecodedMesh decode_draco_features(std::span<const std::byte> bytes, const PairList& features,
                                  const std::string& where);

}  // namespace voxweld
