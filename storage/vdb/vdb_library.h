// OpenVDB, in the child process: openvdb.org. Nothing here runs in the program itself, for the
// library crashes at damaged files.
#pragma once

#include <memory>
#include <string>

#include "storage/vdb/vdb_wire.h"

namespace voxweld {

class VdbLibrary {
 public:
  explicit VdbLibrary(std::string path);
  ~VdbLibrary();
  VdbLibrary(const VdbLibrary&) = delete;
  VdbLibrary& operator=(const VdbLibrary&) = delete;

  // Does talk.task. A survey comes first, then the opening of a grid, then reading. Throws
  // std::exception, of OpenVDB or of ours.
  void answer(VdbTalk& talk);

 private:
  struct State;
  std::string path_;
  std::unique_ptr<State> state_;
};

}  // namespace voxweld
