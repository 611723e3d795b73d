// Formats that are written from a mesh's tiles, one after the other, without holding the mesh: PLY, STL
// and OBJ. Coordinates are those of the Draco files, to the bit.
#pragma once

#include "stages/encode/byte_sink.h"
#include "stages/encode/draco_codec.h"
#include "stages/encode/tile_welder.h"

namespace voxweld {

// What a file has to say of its mesh before that comes.
struct StreamTotals {
  std::uint64_t vertices = 0, triangles = 0;
  bool normals = false;         // there are some
  bool between_labels = false;  // triangles say which labels they separate
  Material highest_label = 0;   // of those, `exterior` left out
};
// A pass over the tiles.
StreamTotals totals_of(const EachTile& each_tile);

// Binary; vertices are welded (TileWelder). A vertex' normal is the mean direction of its normals;
// between labels it has none, and each face has the labels that it separates, `label` and
// `label_outside`: -1 is outside all labels. Three passes over the tiles. InputError past 2^32 - 1
// vertices, and for labels past 2^53: the format has doubles for them.
void stream_ply(const EachTile& each_tile, const StreamTotals& totals, const ByteSink& sink);

// Binary: each triangle with its own normal and three corners. InputError past 2^32 - 1 triangles.
void stream_stl(const EachTile& each_tile, const StreamTotals& totals, const ByteSink& sink);

// Vertices are welded; each corner of a face has its own normal, so edges are as sharp as in the other
// formats. Each tile's vertices, normals and faces come together: so the bytes depend on where the mesh
// is cut, other than those of the two above.
void stream_obj(const EachTile& each_tile, const StreamTotals& totals, const ByteSink& sink);

// What each takes at most beside the tile at hand, of so many vertices, and what a TileWelder keeps of
// those before.
std::uint64_t stream_bytes(std::uint64_t vertices);

// Reads what these write, and any other file of the formats: "ply", "stl" or "obj". Polygons become
// triangles, normals are passed over; points are as the file has them. FormatError, starting with
// `where`, for what is no such file.
DecodedMesh decode_mesh_file(std::span<const std::byte> file, const std::string& format,
                             const std::string& where);

}  // namespace voxweld
