#include "storage/image/slice_files.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <array>
#include <map>
#include <system_error>

#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// Files taken for images in a directory: the name each kind goes by, and its extensions.
struct ImageKind {
  std::string_view name;
  std::array<std::string_view, 4> extensions;
};
constexpr ImageKind image_kinds[] = {
    {"tif", {".tif", ".tiff", ".btf", ".tf8"}},
    {"png", {".png"}},
    {"bmp", {".bmp"}},
    {"jpg", {".jpg", ".jpeg"}},
    {"jp2", {".jp2", ".j2k"}},
    {"exr", {".exr"}},
    {"pnm", {".pgm", ".pnm", ".pbm", ".ppm"}},
    {"dpx", {".dpx"}},
    {"tga", {".tga"}},
    {"webp", {".webp"}},
};

std::string_view image_kind(const fs::path& path) {
  const std::string extension = lower(path.extension().string());
  for (const auto& [kind, extensions] : image_kinds)
    if (!extension.empty() && std::ranges::find(extensions, extension) != extensions.end())
      return kind;
  return {};
}

struct Listing {
  std::map<std::string_view, std::vector<fs::path>> images;  // by kind
  std::vector<std::string> others;
};

Listing list_directory(const fs::path& directory) {
  Listing listing;
  std::error_code error;
  fs::directory_iterator entry(directory, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    std::error_code ignored;
    if (name.starts_with('.') || !entry->is_regular_file(ignored)) continue;
    const std::string_view kind = image_kind(entry->path());
    if (kind.empty())
      listing.others.push_back(name);
    else
      listing.images[kind].push_back(entry->path());
  }
  if (error) throw_errno("list", directory.string(), error.value());
  return listing;
}

std::string describe_kinds(const Listing& listing) {
  std::string text;
  for (const auto& [kind, files] : listing.images)
    text += fmt::format("{}{} {} ({})", text.empty() ? "" : ", ", files.size(), kind,
                        std::min_element(files.begin(), files.end())->filename().string());
  return text;
}

SliceFiles from_directory(const fs::path& directory) {
  Listing listing = list_directory(directory);
  if (listing.images.empty())
    throw InputError(fmt::format(
        "{}: no images in this directory ({} other files); expected slices such as slice_0001.tif",
        directory.string(), listing.others.size()));
  if (listing.images.size() > 1)
    throw InputError(
        fmt::format("{}: images of several kinds in one directory: {}; name the slices by a "
                    "pattern, as in {}",
                    directory.string(), describe_kinds(listing), (directory / "*.tif").string()));
  SliceFiles result{std::move(listing.images.begin()->second), {}};
  if (!listing.others.empty())
    result.warnings.push_back(fmt::format(
        "{}: {} files that are no images are ignored ({}{})", directory.string(),
        listing.others.size(), *std::min_element(listing.others.begin(), listing.others.end()),
        listing.others.size() > 1 ? ", ..." : ""));
  return result;
}

SliceFiles from_pattern(const std::string& pattern) {
  glob_t found{};
  const int status = ::glob(pattern.c_str(), GLOB_NOSORT, nullptr, &found);
  SliceFiles result;
  if (status == 0)
    for (std::size_t i = 0; i < found.gl_pathc; ++i)
      if (fs::is_regular_file(found.gl_pathv[i])) result.paths.emplace_back(found.gl_pathv[i]);
  globfree(&found);
  if (status == GLOB_NOSPACE || status == GLOB_ABORTED)
    throw StorageError("cannot list the files of " + pattern);
  if (result.paths.empty())
    throw InputError(pattern +
                     ": no file matches this pattern; check the directory and the wildcards");
  return result;
}

}  // namespace

bool has_image_name(const fs::path& path) {
  return !image_kind(path).empty();
}

bool is_pattern(const std::string& path) {
  return path.find_first_of("*?[") != std::string::npos;
}

SliceFiles find_slices(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) return from_directory(path);
  if (fs::exists(status)) return {{path}, {}};
  if (is_pattern(path)) return from_pattern(path);
  throw InputError(path +
                   ": no such file or directory; expected a directory of slices, a pattern such as "
                   "dir/slice_*.tif, or one image file");
}

}  // namespace voxweld
