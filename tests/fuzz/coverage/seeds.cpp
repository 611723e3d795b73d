#include "tests/fuzz/coverage/seeds.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "tests/fuzz/ball.h"
#include "tests/fuzz/coverage/entries.h"
#include "tests/fuzz/mutation.h"
#include "tests/fuzz/specimens.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

// The entry for specimens of volumes whose name begins so. Of two the later.
constexpr std::pair<const char*, const char*> volume_names[] = {
    {"nrrd", "nrrd"},      {"metaimage", "metaimage"},
    {"nifti", "nifti"},    {"inrimage", "inrimage"},
    {"mrc", "mrc"},        {"amira", "amira"},
    {"vti", "vti"},        {"vtk", "vtk"},
    {"zarr", "zarr"},      {"n5", "n5"},
    {"tiff", "tiff"},      {"hdf5", "hdf5"},
    {"dicom", "dicom"},    {"stack", "tiff"},
    {"stack-pgm", "image"}};

std::string volume_entry(const std::string& specimen) {
  std::string entry;
  for (const auto& [begin, name] : volume_names)
    if (specimen.starts_with(begin)) entry = name;
  return entry;
}

// The files but the config, what is opened first; of one file its bytes.
std::string bytes_of(const Specimen& specimen) {
  std::vector<std::string> names = specimen.targets;
  std::ranges::stable_partition(names, [&](const std::string& name) {
    return name == specimen.input || name.starts_with(specimen.input + "/");
  });
  std::vector<std::pair<std::string, std::string>> files;
  for (const std::string& name : names)
    files.emplace_back(name, bytes_of_file(specimen.folder / name));
  return files.size() == 1 && specimen.input == names.front() ? files.front().second
                                                              : bundle_of(files);
}

// Files of a finished run by the endings or beginnings of their names.
std::string run_file_entry(const fs::path& file) {
  static const std::map<std::string, std::string> names = {{"manifest.json", "manifest"},
                                                           {"tiles.jsonl", "tiles-list"},
                                                           {"labels.jsonl", "labels-list"}};
  const auto found = names.find(file.filename().string());
  if (found != names.end()) return found->second;
  if (file.extension() == ".drc") return "draco";
  if (file.extension() == ".glb") return "glb";
  const std::string bytes = bytes_of_file(file);
  if (!bytes.starts_with("VOXWELD\x1a")) return "";
  const std::string kind = bytes.substr(8, 4);
  if (kind == "spol") return "spool-record";
  if (kind == "asst") return "asset-record";
  return kind == "shrd" ? "" : "container";  // records of shards want their array's layout
}

std::string one_name(std::string path) {
  std::ranges::replace(path, '/', '-');
  return path;
}

void add_seeds(const Specimen& specimen, std::vector<Seed>& seeds) {
  const std::string& name = specimen.name;
  const std::string target = specimen.targets.front();
  if (const std::string entry = volume_entry(name); !entry.empty())
    seeds.push_back({entry, name, bytes_of(specimen)});
  else if (name.starts_with("config-"))
    seeds.push_back({"config", name, bytes_of_file(specimen.folder / target)});
  else if (name.starts_with("mesh-"))
    seeds.push_back({fs::path(target).extension().string().substr(1), name,
                     bytes_of_file(specimen.folder / target)});
  else if (name.starts_with("labels-"))
    seeds.push_back({"labels-" + fs::path(target).extension().string().substr(1), name,
                     bytes_of_file(specimen.folder / target)});
  else if (name.starts_with("work-") || name.starts_with("output-"))
    for (const std::string& file : specimen.targets) {
      const std::string entry = run_file_entry(specimen.folder / file);
      if (!entry.empty() && fs::file_size(specimen.folder / file) < (std::size_t{64} << 10))
        seeds.push_back(
            {entry, name + "-" + one_name(file), bytes_of_file(specimen.folder / file)});
    }
}

// Chunks of each compressor that zlib can make, and one of none.
void add_chunks(std::vector<Seed>& seeds) {
  const std::string raw = raw_samples().substr(0, 4096);
  const auto add = [&](const std::string& name, char kind, const std::string& bytes) {
    seeds.push_back({"chunk", name, std::string{kind, '\0'} + bytes});
  };
  add("raw", 7, raw);
  add("gzip", 2, packed(raw));
  add("zlib", 2, packed(raw, Wrapper::zlib));
}

}  // namespace

std::vector<Seed> make_seeds(const fs::path& program, const fs::path& scratch) {
  std::vector<Seed> seeds;
  for (const Specimen& specimen : make_specimens(program, scratch)) add_seeds(specimen, seeds);
  add_chunks(seeds);
  return seeds;
}

}  // namespace voxweld::testing
