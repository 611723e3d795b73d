// glTF binaries whose arrays are compressed for quick decoding (EXT_meshopt_compression), and back. The
// only place that knows meshoptimizer.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "stages/encode/glb.h"
#include "stages/encode/glb_format.h"
#include "storage/types/output_lattice.h"

namespace voxweld {

// As write_plain_glb, in the order in which meshes are drawn fastest. Positions decode to the same floats.
// Normals have 10 bits an octahedral coordinate (KHR_mesh_quantization), as .drc has them.
void write_meshopt_glb(DecodedMesh mesh, const OutputLattice& lattice,
                       const GlbParameters& parameters, const ByteSink& sink);

// What `compressed` decodes to, as the view's extension says. FormatError, starting with `where`, or
// Json::exception for what is no such view.
std::vector<std::byte> decode_meshopt_view(const glb::Json& view,
                                           std::span<const std::byte> compressed,
                                           const std::string& where);

}  // namespace voxweld
