// What the manifest of a run says, as parts of a page.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/config/config.h"
#include "pipeline/output/render.h"
#include "storage/manifest/manifest.h"

namespace voxweld {

struct FileSum {
  std::uint64_t files = 0, bytes = 0;
};
struct OutputFacts {
  const Manifest& manifest;
  const Config& config;
  std::optional<MeshBounds> bounds;        // of the mesh, where it could be read
  std::map<std::string, FileSum> formats;  // of mesh files, by name
};

// Of the lists of tiles and of merged meshes.
std::map<std::string, FileSum> sums_by_format(const std::filesystem::path& directory,
                                              const Manifest& manifest);

// Each a table, or empty where the manifest has nothing of the kind.
std::string summary_table(const OutputFacts& facts);
std::string stage_table(const Manifest& manifest);
std::string level_table(const Manifest& manifest);
std::string detail_table(const Manifest& manifest);  // of coarser levels of detail
// The labels with the most volume, or, with an open border, triangles.
std::string label_table(const std::filesystem::path& directory, const Manifest& manifest);

// What one should know of the mesh: sentences.
std::vector<std::string> notes_of(const Manifest& manifest, const Config& config);

}  // namespace voxweld
