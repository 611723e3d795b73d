// An open HDF5 file, and opening what is in it without being led to other files.
#pragma once

#include <string>

#include "storage/hdf5/hdf5_handle.h"
#include "storage/support/file_io.h"

namespace voxweld {

class Hdf5File {
 public:
  // follow: links and data in other files are read. InputError unless the path is a regular file;
  // FormatError for what is no HDF5 file, or a damaged one.
  Hdf5File(const std::string& path, bool follow);

  const std::string& path() const { return file_.path(); }
  const ReadFile& bytes() const { return file_; }
  bool follow() const { return follow_; }
  hid_t id() const { return id_.get(); }
  // How links are followed; for calls that take a path.
  hid_t link_access() const { return link_access_.get(); }

  // Where something in the file is, for messages: "scan.h5: dataset '/a/b'".
  std::string where(const std::string& kind, const std::string& path_in_file) const;

  // Empty where there is none, or none of that kind. `base`: a group; path: within it.
  Hdf5Handle open_group(hid_t base, const std::string& path) const;
  Hdf5Handle open_dataset(hid_t base, const std::string& path) const;
  // That an external link lies on the way, where that is why nothing could be opened.
  bool met_external_link(hid_t base, const std::string& path) const;

 private:
  ReadFile file_;
  bool follow_;
  Hdf5Handle id_, link_access_, dataset_access_;
};

}  // namespace voxweld
