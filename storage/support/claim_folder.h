// A folder that an export writes, and nobody else.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace voxweld {

struct FolderClaim {
  std::filesystem::path folder;
  std::filesystem::path output;  // belongs to runs: the folder must not lie in it
  bool force = false;            // empties it where an earlier export has written all that is in it
  std::string option;            // by which the user names the folder, such as "-o"
  // Whether an export gives such an entry of the folder its name.
  std::function<bool(const std::filesystem::directory_entry&)> is_ours;
  // The file, relative to the folder, that makes it an export, and whether voxweld has written this one.
  std::string mark;
  std::function<bool(const std::filesystem::path&)> is_our_mark;
};

// Makes the folder, or empties it. InputError where there is something else.
void claim_folder(const FolderClaim& claim);

}  // namespace voxweld
