// One file of an output directory.
#pragma once

#include <cstdint>
#include <string>

namespace voxweld {

struct FileRecord {
  std::string path;    // relative to the output directory
  std::string format;  // by its name: "drc", "glb" ...
  std::string role;    // "list", "labels", "merged"; empty in tiles.jsonl
  std::uint64_t bytes = 0;
  std::string xxh3_128;  // to_hex of the file's hash
  friend bool operator==(const FileRecord&, const FileRecord&) = default;
};

}  // namespace voxweld
