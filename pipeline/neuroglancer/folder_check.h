// Whether an export is what clients and the mesh ask for: each level of each object is closed across its
// fragments, no triangle crosses octants, and clients find all there is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/executor/interrupt.h"

namespace voxweld {

struct LevelReport {
  std::uint64_t fragments = 0, triangles = 0;  // fragments: those that have triangles
  std::uint64_t flat = 0;                      // triangles without an area
  std::uint64_t open_edges = 0;
  double volume = 0;  // in the cube of the unit of the object's chunk_shape; of the old format nm^3
};

struct ObjectReport {
  std::uint64_t id = 0;
  std::vector<LevelReport> levels;  // the finest first
};

struct FolderReport {
  std::vector<ObjectReport> objects;
  std::vector<std::string> problems;
  bool good() const { return problems.empty(); }
};

// Memory: a fragment for each thread, and the edges between fragments of one object and level. InputError
// as FolderReader; what is damaged is a problem.
FolderReport check_folder(const std::filesystem::path& folder, int threads = 0,
                          const InterruptFlag* interrupt = nullptr);

// Lines for people, and JSON.
std::string to_text(const FolderReport& report);
std::string to_json_text(const FolderReport& report);

}  // namespace voxweld
