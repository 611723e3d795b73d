#include "tests/fuzz/coverage/seeds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <set>

#include "storage/artifact/container.h"
#include "storage/manifest/task_report.h"
#include "storage/spool/spool_record.h"
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
  std::stable_partition(names.begin(), names.end(), [&](const std::string& name) {
    return name == specimen.input || name.starts_with(specimen.input + "/");
  });
  std::vector<std::pair<std::string, std::string>> files;
  files.reserve(names.size());
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
  if (file.extension() == ".vtp") return "vtp";
  const std::string bytes = bytes_of_file(file);
  if (!bytes.starts_with("VOXWELD\x1a")) return "";
  const std::string kind = bytes.substr(8, 4);
  if (kind == "spol") return "spool-record";
  if (kind == "asst") return "asset-record";
  return "container";
}

std::string one_name(std::string path) {
  std::ranges::replace(path, '/', '-');
  return path;
}

// The same as sections, whose checksums are made anew.
std::string sections_of(const fs::path& path, const std::string& bytes) {
  ArtifactStamp stamp;
  std::memcpy(stamp.kind.data(), bytes.data() + 8, 4);
  std::memcpy(&stamp.version, bytes.data() + 12, 4);
  const ArtifactReader file(path, stamp.kind, stamp.version);
  std::string text = bytes.substr(8, 4);
  std::vector<std::byte> data;
  for (const SectionRecord& section : file.sections()) {
    file.read(section.name, data);
    text.append(reinterpret_cast<const char*>(&section.name), 8);
    const auto size = static_cast<std::uint32_t>(data.size());
    text.append(reinterpret_cast<const char*>(&size), 4);
    text.append(reinterpret_cast<const char*>(data.data()), data.size());
  }
  return text;
}

void add_run_files(const Specimen& specimen, std::vector<Seed>& seeds) {
  for (const std::string& file : std::set(specimen.targets.begin(), specimen.targets.end())) {
    const fs::path path = specimen.folder / file;
    const std::string entry = run_file_entry(path), bytes = bytes_of_file(path);
    if (entry.empty() || bytes.size() > (std::size_t{64} << 10)) continue;
    const std::string name = specimen.name + "-" + one_name(file);
    seeds.push_back({entry, name, bytes});
    if (entry == "container") seeds.push_back({"sections", name, sections_of(path, bytes)});
  }
}

// What no specimen has by itself.
void add_records(const fs::path& folder, std::vector<Seed>& seeds) {
  TaskReport report;
  report.stage = "build";
  report.units = 3;
  report.wall_s = 1.5;
  report.failures.push_back({.unit = 7, .message = "no", .exit_code = 2, .damaged_path = "a/b"});
  report.provenance = "{}";
  write_task_report(folder / "report", report);
  seeds.push_back({"task-report", "failed", bytes_of_file(folder / "report")});
  SpoolRecord record;
  record.info.format = "nrrd";
  record.info.geometry.size = {size_x, size_y, size_z};
  record.info.files.push_back({"/nowhere/v.nrrd", {}});
  record.info.warnings.push_back("no unit");
  write_spool_record(folder / "v", record);
  seeds.push_back({"spool-record", "nrrd", bytes_of_file(spool_record_path(folder / "v"))});
}

// For the reader itself, and, where the reader is in the program, for finding out whose it is.
void add_volume(const Specimen& specimen, const std::string& entry, std::vector<Seed>& seeds) {
  const std::string bytes = bytes_of(specimen);
  seeds.push_back({entry, specimen.name, bytes});
  if (parser_named(entry)->module.empty()) seeds.push_back({"detect", specimen.name, bytes});
}

void add_seeds(const Specimen& specimen, std::vector<Seed>& seeds) {
  const std::string& name = specimen.name;
  const std::string target = specimen.targets.front();
  if (const std::string volume = volume_entry(name); !volume.empty())
    add_volume(specimen, volume, seeds);
  else if (name.starts_with("config-"))
    seeds.push_back({"config", name, bytes_of_file(specimen.folder / target)});
  else if (name.starts_with("mesh-"))
    seeds.push_back({fs::path(target).extension().string().substr(1), name,
                     bytes_of_file(specimen.folder / target)});
  else if (name.starts_with("labels-"))
    seeds.push_back({"labels-" + fs::path(target).extension().string().substr(1), name,
                     bytes_of_file(specimen.folder / target)});
  else if (name.starts_with("work-") || name.starts_with("output-"))
    add_run_files(specimen, seeds);
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
  add_records(scratch, seeds);
  return seeds;
}

}  // namespace voxweld::testing
