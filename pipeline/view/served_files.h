// What the viewer's server may hand out: the files of one folder, or one file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace voxweld {

class ServedFiles {
 public:
  // InputError where there is neither a folder nor a file.
  explicit ServedFiles(const std::filesystem::path& path);

  // As it was named.
  const std::filesystem::path& path() const { return path_; }
  bool is_folder() const { return is_folder_; }
  // The name of the folder or file, without what leads to it.
  std::string name() const { return root_.filename().string(); }

  // The file of a name relative to the folder, or of the one file's own name. Nothing where it is no
  // file, or lies elsewhere: names that are absolute or have ".." in them, and links that lead out.
  std::optional<std::filesystem::path> find(const std::string& name) const;

 private:
  std::filesystem::path path_, root_;  // root: without links in it
  bool is_folder_ = false;
};

}  // namespace voxweld
