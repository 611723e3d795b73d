// Checks an output directory against its manifest and against what voxweld promises: files whole,
// tiles that weld without a crack into a closed (or, on the border, open) 2-manifold. With
// labels.mode = "each" that is so for each label by itself, one after the other, and its volume,
// area and bounds are those that labels.jsonl says.
//
// One tile at a time is decoded and checked for each thread; of a tile only what touches others
// stays: its seam vertices, the half-edges between them and the fans around them. So the memory
// taken is a tile for each thread plus all seams (of one label), whatever the size of the mesh. The
// merged mesh, where there is one, is held whole; of files that were streamed only its vertices.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/executor/interrupt.h"
#include "pipeline/output/intersection_check.h"
#include "stages/encode/mesh_writers.h"

namespace voxweld {

struct VerifyOptions {
  int threads = 0;  // 0: as many as cores
  std::size_t listed_problems = 20;
  bool merged = true;                        // also decode the merged mesh and build it in OpenMesh
  bool origin = true;                        // also look at input and config, where they are there
  bool intersections = false;                // also count triangles that intersect
  MeshWriters formats = mesh_writers();      // those it knows how to read
  const InterruptFlag* interrupt = nullptr;  // asked before each tile and file
};

struct Problem {
  std::string where;  // file, or tile and position
  std::string what;
};

struct VerifyReport {
  std::uint64_t files = 0, bytes = 0;  // read and hashed
  std::uint64_t tiles = 0;
  std::uint64_t vertices = 0;  // of the welded mesh
  std::uint64_t triangles = 0;
  std::uint64_t seam_vertices = 0;                 // in more than one tile, equal in all to the bit
  std::uint64_t boundary_edges = 0;                // of the welded mesh
  std::optional<IntersectionCount> intersections;  // where asked for; of labels within each
  std::uint64_t labels = 0;  // with a mesh of their own, all of the above their sum
  std::uint64_t levels = 0;  // of detail, beside the mesh itself, each as closed as it
  bool merged_checked = false;
  std::uint64_t problem_count = 0;
  std::vector<Problem> problems;  // the first of them

  bool good() const { return problem_count == 0; }
};

// Throws Interrupted where a stop was asked for.
// Problems of the output are in the report; what is thrown: StorageError when the directory's
// manifest or tile list cannot be read, FormatError when they are not what manifest.h describes.
VerifyReport verify_output(const std::filesystem::path& directory,
                           const VerifyOptions& options = {});

std::string to_text(const VerifyReport& report);
std::string to_json_text(const VerifyReport& report);  // one object, with a newline

}  // namespace voxweld
