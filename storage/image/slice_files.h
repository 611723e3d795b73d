// Which files make up a slice stack, and in what order.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace voxweld {

struct SliceFiles {
  std::vector<std::filesystem::path> paths;  // in z order, at least one
  std::vector<std::string> warnings;
};

// Lists the slices that `path` names: an existing directory (all its images; hidden files and other
// kinds are passed over), an existing file (that one), or a glob pattern.
// Throws InputError when there is none, or when a directory mixes kinds of images.
SliceFiles find_slices(const std::string& path);

// By its extension. Slices in a directory have such a name.
bool has_image_name(const std::filesystem::path& path);
// Whether it holds wildcards.
bool is_pattern(const std::string& path);

// Puts the files in z order by the number in their names ("slice2" before "slice10").
// Throws InputError when numbers are missing or occur twice, when names of a different form are
// among them, or when more than one number varies and none tells the order.
SliceFiles order_slices(std::vector<std::filesystem::path> paths);

// Compares runs of digits by value and everything else by character; ties are broken by plain
// comparison, so the order is total.
bool natural_less(std::string_view a, std::string_view b);

}  // namespace voxweld
