// A small sound one of everything that voxweld reads, and what to do with it.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace voxweld::testing {

using Words = std::vector<std::string>;

struct Specimen {
  std::string name;
  std::filesystem::path folder;      // to be copied; commands run in the copy
  std::vector<std::string> targets;  // files in it that may be changed
  std::string input;                 // of volumes: the file or folder that is opened
  std::vector<Words> commands;       // voxweld's arguments
  // Of outputs and work: what is in case.mesh, by name, but the manifest. Whatever becomes of them,
  // a run leaves this again.
  std::map<std::string, std::string> clean;
};

// Makes them below `root` with the program; without one (an empty path) those that need none. The
// same each time but for times and names.
std::vector<Specimen> make_specimens(const std::filesystem::path& program,
                                     const std::filesystem::path& root);

// Files of the output directory, name -> bytes, but the manifest.
std::map<std::string, std::string> output_files(const std::filesystem::path& output);

// Writes volumes in every format into folders below `root`: one specimen each, without commands.
std::vector<Specimen> write_volumes(const std::filesystem::path& program,
                                    const std::filesystem::path& root);

}  // namespace voxweld::testing
