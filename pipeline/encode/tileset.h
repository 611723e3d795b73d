// The levels of detail as a tileset of 3D Tiles 1.1: tileset.json, and nested files where there are
// many tiles. Tiles are the .glb files that are there anyway.
//
// Based on: Open Geospatial Consortium, "3D Tiles Specification" 1.1 (OGC 22-025r4, 2023).
//
// A coarser tile takes the place of its children (REPLACE), in any order and at any mix of levels: their
// borders are the same triangles, so there is neither crack nor skirt. A tile's geometric error is in
// metres, as 3D Tiles has it: its tolerance, or the distance of the 99th percentile where that is more.
// (By the largest distance, which a few triangles have, clients loaded twelve times as much for the same
// picture.) Of the mesh itself 0, since nothing finer is there. That of the tileset, which viewers take for the
// error of showing nothing at all, is the diagonal of its box. Boxes hold what is in a tile and in all
// its children, and lie as the volume does in the world.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/stage/artifacts.h"
#include "pipeline/stage/level_meshes.h"
#include "storage/types/file_record.h"
#include "storage/types/lattice_box.h"

namespace voxweld {

// What a tileset says of a mesh.
struct TilesetMesh {
  std::optional<LatticeBox> box;  // nothing where it has no triangle
  std::string file;               // relative to the output directory; empty: none
};

struct TilesetInputs {
  const LevelMeshes& levels;
  const std::vector<LevelError>& errors;  // of its nodes
  OutputLattice lattice;                  // of the files
  VolumeGeometry frame;
  std::filesystem::path output;
  std::string source;                             // the volume's file name
  const std::vector<TilesetMesh>&leaves, &nodes;  // of the tree
};

// The name of the nested file that begins with this node.
std::string tileset_name_of(const LevelNode& node);
// Of each node whether it has one.
std::vector<bool> nested_tilesets(const LevelTree& tree);

// Writes them and returns what they are, the file to open first.
std::vector<FileRecord> write_tileset(const TilesetInputs& inputs);

}  // namespace voxweld
