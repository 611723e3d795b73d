// The module libvoxweld_hdf5.so.
#include <fmt/format.h>

#include <memory>

#include "storage/hdf5/hdf5_catalog.h"
#include "storage/hdf5/hdf5_geometry.h"
#include "storage/hdf5/hdf5_source.h"
#include "storage/modules/reader_module.h"
#include "storage/support/child_process.h"
#include "storage/support/error.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

void refuse_level(const InputSpec& spec) {
  if (spec.select.level)
    throw InputError(
        spec.path +
        ": input.level (--level) is set, but only Imaris files have levels: remove it, "
        "and name the dataset by input.dataset or --dataset");
}

[[noreturn]] void fail_open(const Hdf5File& file, const std::string& path) {
  const std::string where = file.where("dataset", path);
  if (!file.follow() && file.met_external_link(file.id(), path))
    throw FormatError(where +
                      ": lies in another file, behind an external link: set input.follow = true "
                      "(--follow) if that is to be read");
  if (file.open_group(file.id(), path))
    throw InputError(where + ": is a group: name a dataset in it; `voxweld info` lists them");
  throw InputError(where + ": there is no such dataset; `voxweld info` lists them");
}

FoundVolume plain_volume(const Hdf5File& file, const InputSpec& spec) {
  refuse_level(spec);
  FoundVolume found;
  const std::string path = chosen_dataset(file, spec, found.info);
  found.dataset = file.open_dataset(file.id(), path);
  if (!found.dataset) fail_open(file, path);
  const hid_t dataset = found.dataset.get();
  found.facts = dataset_facts(file, dataset, path);
  std::vector<std::string> names = dimension_names(dataset, found.facts.dims.size());
  const std::vector<std::string> nexus = nexus_axes(file, dataset, found.facts);
  if (names.empty()) names = nexus;
  found.place = place_volume(found.facts, names, spec, file.where("dataset", path), found.info);
  found.info.geometry.size = size_of(found.facts, found.place);
  read_hdf5_geometry(file, dataset, found.facts, found.place, spec, found.info);
  return found;
}

std::unique_ptr<SampleSource> open_source(const InputSpec& spec) {
  const auto file = std::make_shared<const Hdf5File>(spec.path, spec.follow);
  std::optional<FoundVolume> found = imaris_volume(*file, spec);
  if (!found && (found = minc_volume(*file, spec))) refuse_level(spec);
  if (!found) found = plain_volume(*file, spec);
  found->info.format = "hdf5";
  found->info.type = *found->facts.type.type;
  if (found->facts.type.text == "float16")
    found->info.warnings.push_back(file->where("dataset", found->facts.path) +
                                   ": floats of 16 bits are read as such of 32");
  return make_hdf5_source(file, std::move(*found));
}

// libhdf5 crashes at some damaged files (those of version 1.10.8: global heaps, for one), so opening
// is tried in a child process first. All that is said of the file is read in it, with the index of
// its chunks. Under the lock: no other thread is inside the library then.
std::unique_ptr<SampleSource> open_hdf5(const InputSpec& spec) {
  constexpr unsigned most_seconds = 120;
  require_input_file(spec.path);
  const Hdf5Lock lock;
  switch (try_in_child([&] { open_source(spec); }, most_seconds)) {
    case TrialEnd::survived:
      return open_source(spec);
    case TrialEnd::crashed:
      throw FormatError(spec.path +
                        ": damaged: libhdf5 crashes when it opens it; get a sound copy, or see "
                        "whether h5repack can read it");
    default:
      throw FormatError(
          fmt::format("{}: libhdf5 works on opening it for more than {} s; it may be damaged: get "
                      "a sound copy, "
                      "or copy the dataset into a file of its own",
                      spec.path, most_seconds));
  }
}

Module* hdf5_module() {
  static ReaderModule module({{.name = "hdf5", .files = {}, .test = {}, .open = open_hdf5}});
  return &module;
}

}  // namespace
}  // namespace voxweld

const voxweld::ModuleEntry voxweld_module_entry = {voxweld::module_version, voxweld::hdf5_module};
