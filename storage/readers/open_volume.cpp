#include "storage/readers/open_volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "storage/dicom/dicom_probe.h"
#include "storage/hdf5/hdf5_reader.h"
#include "storage/image/stack_source.h"
#include "storage/modules/module_loader.h"
#include "storage/store/open_zarr.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"
#include "storage/vdb/vdb_reader.h"
#include "storage/volumes/data_layout.h"
#include "storage/volumes/filters.h"
#include "storage/volumes/inflate_stream.h"
#include "storage/volumes/readers.h"
#include "storage/vtk/readers.h"

namespace voxweld {
namespace {

constexpr std::size_t head_bytes = 4096;

const VolumeReader& reader_by_name(const InputSpec& spec, std::span<const VolumeReader> readers) {
  const auto found = std::ranges::find(readers, spec.format, &VolumeReader::name);
  if (found != readers.end()) return *found;
  throw InputError(fmt::format("{}: unknown input format '{}': use \"auto\" or one of {}",
                               spec.path, spec.format, reader_names(readers)));
}

const VolumeReader& reader_by_probe(const InputSpec& spec, std::span<const VolumeReader> readers) {
  const InputProbe probe = probe_input(spec.path);
  const VolumeReader* by_name = nullptr;
  for (const VolumeReader& reader : readers) {
    const Match match = reader.test(probe);
    if (match == Match::contents) return reader;
    if (match == Match::extension && by_name == nullptr) by_name = &reader;
  }
  // A stated layout is as good as the name ".raw".
  if (by_name == nullptr && probe.is_file && spec.raw.size && spec.raw.type)
    by_name = &reader_by_name({.path = spec.path, .format = "raw"}, readers);
  if (is_url(spec.path))
    throw InputError(spec.path +
                     ": the server has no zarr.json, .zarray, .zgroup or attributes.json there; "
                     "correct the address. Of other formats than Zarr and N5, download the files");
  if (by_name != nullptr) return *by_name;
  require_input_file(spec.path);
  throw InputError(fmt::format(
      "{}: a file of an unknown kind; supported are {}. For headerless samples set the format to "
      "\"raw\" and give size and type",
      spec.path, reader_names(readers)));
}

// What chooses among several volumes, handed to a reader that knows of none.
void check_selection(const VolumeReader& reader, const InputSpec& spec) {
  const auto refuse = [&](const char* key) {
    throw InputError(
        fmt::format("{}: input.{} (--{}) is set, and {} files have no such choice; remove it",
                    spec.path, key, key, reader.name));
  };
  for (const Selector selector : selectors)
    if (spec.select.has(selector) &&
        std::ranges::find(reader.selects, selector) == reader.selects.end())
      refuse(selector_name(selector));
  if (spec.resample != Resample::none && !reader.resamples) refuse("resample");
}

}  // namespace

InputProbe probe_input(const std::string& path) {
  InputProbe probe{.path = path, .extension = name_extension(path)};
  std::error_code error;
  probe.is_directory = std::filesystem::is_directory(path, error);
  probe.is_file = std::filesystem::is_regular_file(path, error);
  if (!probe.is_file) return probe;
  const ReadFile file(path);
  probe.head.resize(static_cast<std::size_t>(std::min<std::uint64_t>(head_bytes, file.size())));
  file.read(0, probe.head);
  if (!looks_gzip(probe.head)) return probe;
  try {
    probe.inflated_head.resize(head_bytes);
    InflateStream stream(file, 0);
    probe.inflated_head.resize(stream.read_some(probe.inflated_head));
  } catch (const FormatError&) {
    // Damaged or cut short: not for detection to judge. The reader that its name leads to will.
    probe.inflated_head.clear();
  }
  return probe;
}

std::span<const VolumeReader> volume_readers() {
  static const std::vector<VolumeReader> table = {
      nrrd_reader(),  metaimage_reader(), nifti_reader(), inrimage_reader(), vti_reader(),
      vtk_reader(),   mrc_reader(),       amira_reader(), raw_reader(),      zarr_reader(),
      n5_reader(),    dicom_reader(),     hdf5_reader(),  vdb_reader(),
      stack_reader(),  // last: it takes every directory
  };
  return table;
}

std::string reader_names(std::span<const VolumeReader> readers) {
  std::string names;
  for (const VolumeReader& reader : readers) names += (names.empty() ? "" : ", ") + reader.name;
  return names;
}

std::unique_ptr<SampleSource> open_volume(const InputSpec& spec,
                                          std::span<const VolumeReader> readers) {
  if (spec.path.empty()) throw InputError("the input has no path: name a volume file");
  const VolumeReader& reader =
      spec.format == "auto" ? reader_by_probe(spec, readers) : reader_by_name(spec, readers);
  check_selection(reader, spec);
  std::unique_ptr<SampleSource> source =
      reader.module.empty() ? reader.open(spec) : open_by_module(reader, spec);
  if (spec.spacing || !spec.unit.empty())
    source = override_source(std::move(source), {.spacing = spec.spacing, .unit = spec.unit});
  if (spec.crop) source = crop_source(std::move(source), *spec.crop);
  return source;
}

}  // namespace voxweld
