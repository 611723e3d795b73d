#include "pipeline/view/served_files.h"

#include <algorithm>

#include "storage/support/error.h"

namespace voxweld {

namespace fs = std::filesystem;

namespace {

// A plain way down: no part that leads up, stays or is empty, and nothing that begins at the top.
bool leads_down(const std::string& name) {
  const fs::path path(name);
  return !name.empty() && name.find('\0') == std::string::npos && path.is_relative() &&
         std::ranges::none_of(path, [](const fs::path& part) {
           return part.empty() || part == "." || part == "..";
         });
}

bool lies_in(const fs::path& folder, const fs::path& file) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first ==
         folder.end();
}

}  // namespace

ServedFiles::ServedFiles(const fs::path& path) : path_(path) {
  std::error_code error;
  root_ = fs::canonical(path, error);
  if (error) throw InputError(path.string() + ": no such file or directory");
  is_folder_ = fs::is_directory(root_);
  // Pipes and devices would keep whoever reads them waiting.
  if (!is_folder_ && !fs::is_regular_file(root_))
    throw InputError(path.string() + ": neither a file nor a directory");
}

std::optional<fs::path> ServedFiles::find(const std::string& name) const {
  if (!leads_down(name)) return std::nullopt;
  if (!is_folder_) return name == this->name() ? std::optional(root_) : std::nullopt;
  std::error_code error;
  const fs::path file = fs::canonical(root_ / name, error);
  if (error || !lies_in(root_, file) || !fs::is_regular_file(file, error)) return std::nullopt;
  return file;
}

}  // namespace voxweld
