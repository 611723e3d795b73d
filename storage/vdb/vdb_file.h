// A .vdb file, read by OpenVDB in a child process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>

#include "storage/support/child_service.h"
#include "storage/types/file_state.h"
#include "storage/vdb/vdb_wire.h"

namespace voxweld {

class VdbFile {
 public:
  // Reads what stands before the grids. FormatError where the file is none, cut short or damaged.
  explicit VdbFile(std::string path);

  const std::string& path() const { return path_; }
  const FileState& state() const { return state_; }
  std::span<const VdbGrid> grids() const;

  struct OpenGrid {
    Box3 active;              // of active voxels; empty where there is none
    std::uint64_t bytes = 0;  // that the child keeps, beside what a box takes
  };
  // Reads where the grid has leaves and tiles, not what is in the leaves.
  OpenGrid open(std::size_t grid);

  // The samples of the box, indices of the opened grid; `bytes` a sample. From any thread; one is
  // served at a time. FormatError where they are damaged.
  void read(const Box3& box, std::size_t bytes, std::byte* out) const;

 private:
  void ask(VdbTask task, const std::string& what) const;
  VdbTalk& talk() const;

  std::string path_;
  FileState state_;
  ServiceRules rules_;
  mutable std::mutex one_;
  mutable ChildService child_;
};

}  // namespace voxweld
