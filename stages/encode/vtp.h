// VTK's XML PolyData, for ParaView and all that is made with VTK: written from a mesh's tiles, and back.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "stages/encode/mesh_streams.h"

namespace voxweld {

// Raw binary, without compression. Vertices are welded (TileWelder); a vertex' normal is the mean
// direction of its normals. Between labels vertices have none, and each triangle has the labels that it
// separates, `label` and `label_outside`: -1 is outside all labels. Three passes over the tiles, four
// between labels. InputError for labels past 2^63 - 1.
void stream_vtp(const EachTile& each_tile, const StreamTotals& totals, const ByteSink& sink);

// How many bits a file has for a label, by the highest there is in it.
int vtp_label_bits(Material highest);

// A file, or bytes in memory. read: those from a place on that lies in it.
struct VtpSource {
  std::uint64_t size = 0;
  std::function<void(std::uint64_t at, std::span<std::byte> to)> read;
};
class VtpSink {
 public:
  virtual ~VtpSink() = default;
  virtual void vertex(const std::array<float, 3>& place) = 0;
  // After all vertices. pair: null where the file has no labels.
  virtual void triangle(const std::array<std::uint32_t, 3>& corners, const MaterialPair* pair) = 0;
};
// Reads what stream_vtp writes, in a small constant of memory; normals are passed over. FormatError,
// starting with `where`, for anything else: also for other files of PolyData.
void read_vtp(const VtpSource& source, const std::string& where, VtpSink& sink);
// The same into memory.
DecodedMesh decode_vtp(std::span<const std::byte> file, const std::string& where);

}  // namespace voxweld
