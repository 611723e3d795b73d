// From the <TiffData> elements of an OME-TIFF to pages of files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "storage/image/ome_metadata.h"
#include "storage/image/stack_plan.h"

namespace voxweld {

// Planes of an image along z, channel and time; samples of one pixel are no channels here.
struct OmeSizes {
  std::int64_t z = 1, c = 1, t = 1;
};
// How far apart the planes of neighbours along each are in the image's order of planes.
struct OmeStrides {
  std::int64_t z = 1, c = 1, t = 1;
};
// Nothing where the DimensionOrder is none of the six. Precondition: the product of sizes fits.
std::optional<OmeStrides> ome_strides(const std::string& order, const OmeSizes& sizes);

// Planes first, first + step ... of `total`.
struct OmeWanted {
  std::int64_t first = 0, step = 1, count = 1, total = 1;
};

// The files that hold an image, as they are needed.
class OmeFiles {
 public:
  struct Settings {
    std::filesystem::path metadata;  // the file that holds the XML; others are named from there
    std::filesystem::path own;       // the TIFF that was opened; empty of a companion file
    std::string own_uuid;
    bool follow = false;  // names may lead out of the folder
  };
  explicit OmeFiles(Settings settings) : settings_(std::move(settings)) {}

  // Where all images name one file, and it is not there, it is the one that was opened: renamed.
  void allow_renamed(const std::vector<OmeImage>& images, std::vector<std::string>& warnings);
  // FormatError, naming it, where the file is missing.
  std::size_t find(const OmePages& pages);
  const std::filesystem::path& path(std::size_t file) const { return paths_[file]; }
  const std::vector<std::filesystem::path>& paths() const { return paths_; }
  std::int64_t page_count(std::size_t file);

 private:
  std::size_t add(const std::filesystem::path& path);

  Settings settings_;
  bool renamed_ = false;
  std::vector<std::filesystem::path> paths_;
  std::map<std::string, std::size_t> by_path_;
  std::map<std::size_t, std::int64_t> page_counts_;
};

// The pages that hold the wanted planes, in their order. FormatError where one is not told of, or
// told of twice, or not in its file.
std::vector<StackPlane> find_ome_planes(const std::vector<OmePages>& pages, const OmeImage& image,
                                        const OmeWanted& wanted, OmeFiles& files);

}  // namespace voxweld
