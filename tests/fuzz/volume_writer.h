// Specimens of volumes, each in a folder of its own with a config that reads it.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tests/fuzz/mutation.h"
#include "tests/fuzz/specimens.h"

namespace voxweld::testing {

class VolumeWriter {
 public:
  explicit VolumeWriter(const std::filesystem::path& root) : root_(root) {}

  // A specimen of these files; the config reads the first. More lines of [input] may be needed.
  void add(const std::string& name, const std::vector<std::pair<std::string, std::string>>& files,
           const std::string& input_lines = "") {
    Specimen specimen = begin(name);
    for (const auto& [file, bytes] : files) {
      std::filesystem::create_directories((specimen.folder / file).parent_path());
      write_bytes(specimen.folder / file, bytes);
      specimen.targets.push_back(file);
    }
    finish(std::move(specimen), files.front().first, input_lines);
  }
  Specimen begin(const std::string& name) const {
    Specimen specimen;
    specimen.name = name;
    specimen.folder = root_ / name;
    std::filesystem::create_directories(specimen.folder);
    return specimen;
  }
  // All files but the config may be changed where none is named.
  void finish(Specimen specimen, const std::string& input, const std::string& input_lines = "") {
    if (specimen.targets.empty())
      for (const auto& entry : std::filesystem::recursive_directory_iterator(specimen.folder))
        if (entry.is_regular_file())
          specimen.targets.push_back(
              std::filesystem::relative(entry.path(), specimen.folder).string());
    std::sort(specimen.targets.begin(), specimen.targets.end());
    specimen.input = input;
    write_bytes(specimen.folder / "case.toml",
                fmt::format("[input]\npath = \"{}\"\n{}[surface]\nisovalue = 100\n[work]\nbrick = "
                            "16\nshard = 2\nchunk = 16\n[run]\nthreads = 2\nmemory = \"256MiB\"\n",
                            input, input_lines));
    specimen.commands = {{"info", input},
                         {"info", input, "--check"},
                         {"info", input, "--histogram", "--json"},
                         {"init", input, "-o", "new.toml"},
                         {"run", "case.toml"},
                         {"run", "case.toml", "--set", "work.copy=true"},
                         {"run", "case.toml", "--dry-run"},
                         {"plan", "case.toml"}};
    if (specimen.name == "raw")
      for (Words& words : specimen.commands)
        if (words.front() == "info" || words.front() == "init")
          words.insert(words.begin() + 2, {"--size", "20", "18", "16", "--type", "int16"});
    all_.push_back(std::move(specimen));
  }
  std::vector<Specimen> take() { return std::move(all_); }

 private:
  std::filesystem::path root_;
  std::vector<Specimen> all_;
};

// Formats of one file or of a header and its data.
void write_files(VolumeWriter& to);
// Zarr, N5 and HDF5. scratch: a folder that may be written to.
void write_arrays(VolumeWriter& to, const std::filesystem::path& program,
                  const std::filesystem::path& scratch);
// TIFF, DICOM and other images.
void write_images(VolumeWriter& to);

}  // namespace voxweld::testing
