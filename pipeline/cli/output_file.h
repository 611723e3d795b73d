// The file a command writes: it goes over nothing unless that is asked for, and never over what the
// command reads.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <span>
#include <string>

namespace voxweld {

struct OutputFile {
  std::string path;
  bool force = false;
};

// -o and --force. help: of -o.
void add_output_file(CLI::App& command, OutputFile& output, const std::string& help);

// Throws InputError where something is there already and `force` is not set, and where it is no
// file that could be replaced.
void check_free(const std::filesystem::path& file, bool force);

// Throws InputError where the two are one file, under whatever names and through whatever links.
void refuse_input(const std::filesystem::path& file, const std::filesystem::path& input);

// Throws InputError where the name does not end in one of these, such as ".png", in any letter
// case. what: is written, for the message: "a picture".
void check_ending(const std::filesystem::path& file, std::span<const std::string> endings,
                  const std::string& what);

}  // namespace voxweld
