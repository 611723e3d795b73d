#include "storage/support/error.h"

#include <cerrno>
#include <cstring>

namespace voxweld {

bool StorageError::disk_full() const {
  return error_number_ == ENOSPC || error_number_ == EDQUOT;
}

void throw_errno(const std::string& verb, const std::string& path, int error) {
  std::string hint;
  if (error == ENOSPC || error == EDQUOT)
    hint = " (free some space and run again: finished work is kept)";
  if (error == EACCES || error == EROFS) hint = " (check the permissions of the directory)";
  throw StorageError("cannot " + verb + " " + path + ": " + std::strerror(error) + hint, error);
}

}  // namespace voxweld
