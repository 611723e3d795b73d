// What encoding to Draco buffers and decoding them are made of: used by draco_codec and fragment_codec.
#pragma once

#include <draco/core/encoder_buffer.h>
#include <draco/mesh/mesh.h>

#include <memory>
#include <string>
#include <vector>

#include "stages/encode/draco_codec.h"
#include "storage/types/tile_mesh.h"

namespace voxweld {

// FormatError, starting with `where`, unless the buffer starts as a Draco mesh of bitstream 2.2
// without metadata (what Draco 1.4 and later write) whose stated counts are plausible for its size:
// before Draco allocates by what they state.
void check_draco_header(std::span<const std::byte> bytes, const std::string& where);

// After that check. FormatError, starting with `where`, for damaged data.
std::unique_ptr<draco::Mesh> decode_draco_mesh(std::span<const std::byte> bytes,
                                               const std::string& where);

std::vector<std::byte> copy_bytes(const draco::EncoderBuffer& buffer);

struct DracoAttributes {
  int position = 0;
  int normal = -1;  // -1: none
  int pair = -1;
  int colour = -1;
  // Few vertices have several normals: then it is encoded with a vertex for each of them, not with normals
  // as seams on the connectivity of positions. The decoded points are the same.
  bool one_normal_each = false;
};

// colours: null unless encode_draco has them. Precondition: the mesh is one that encode_draco takes.
DracoAttributes fill_draco_mesh(const TileMesh& mesh, bool normals,
                                const std::vector<PairColour>* colours, draco::Mesh& out);

// Fills pairs and triangle_pairs where the mesh has them. features: as of decode_draco. FormatError,
// starting with `where`.
void read_pairs(const draco::Mesh& mesh, const PairList* features, DecodedMesh& out,
                const std::string& where);

}  // namespace voxweld
