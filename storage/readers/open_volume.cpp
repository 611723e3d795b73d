#include "storage/readers/open_volume.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/data_layout.h"
#include "storage/volumes/filters.h"
#include "storage/volumes/inflate_stream.h"
#include "storage/volumes/inrimage_reader.h"
#include "storage/volumes/metaimage_reader.h"
#include "storage/volumes/nifti_reader.h"
#include "storage/volumes/nrrd_reader.h"
#include "storage/volumes/raw_reader.h"

namespace voxweld {
namespace {

constexpr std::size_t head_bytes = 4096;

std::string probe_extension(const std::filesystem::path& path) {
  std::string last = lower(path.extension().string());
  if (last != ".gz") return last;
  return lower(path.stem().extension().string()) + last;
}

std::string supported_list(std::span<const ReaderEntry> readers) {
  std::vector<std::string> items;
  for (const ReaderEntry& reader : readers)
    items.push_back(fmt::format("{} ({})", reader.name, reader.files));
  return fmt::format("{}", fmt::join(items, ", "));
}

const ReaderEntry& reader_by_name(const InputSpec& spec, std::span<const ReaderEntry> readers) {
  const auto found = std::ranges::find(readers, spec.format, &ReaderEntry::name);
  if (found != readers.end()) return *found;
  throw InputError(fmt::format("{}: unknown input format '{}': use \"auto\" or one of: {}",
                               spec.path, spec.format, supported_list(readers)));
}

const ReaderEntry& reader_by_probe(const InputSpec& spec, std::span<const ReaderEntry> readers) {
  const InputProbe probe = probe_input(spec.path);
  const ReaderEntry* by_name = nullptr;
  for (const ReaderEntry& reader : readers) {
    const Match match = reader.sniff(probe);
    if (match == Match::contents) return reader;
    if (match == Match::extension && by_name == nullptr) by_name = &reader;
  }
  // A stated layout is as good as the name ".raw".
  if (by_name == nullptr && probe.is_file && spec.raw.size && spec.raw.type)
    by_name = &reader_by_name({.path = spec.path, .format = "raw"}, readers);
  if (by_name != nullptr) return *by_name;
  if (!probe.is_directory) require_input_file(spec.path);
  throw InputError(fmt::format(
      "{}: {} of an unknown kind: supported are: {}. For headerless samples set the "
      "format to \"raw\" and give size and type",
      spec.path, probe.is_directory ? "a directory" : "a file", supported_list(readers)));
}

}  // namespace

InputProbe probe_input(const std::string& path) {
  InputProbe probe{.path = path, .extension = probe_extension(path)};
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

std::vector<ReaderEntry> builtin_readers() {
  return {
      {"nrrd", ".nrrd, .nhdr", sniff_nrrd, [](const InputSpec& s) { return open_nrrd(s.path); }},
      {"metaimage", ".mha, .mhd", sniff_metaimage,
       [](const InputSpec& s) { return open_metaimage(s.path); }},
      {"nifti", ".nii, .nii.gz, .hdr + .img", sniff_nifti,
       [](const InputSpec& s) { return open_nifti(s.path); }},
      {"inrimage", ".inr, .inr.gz", sniff_inrimage,
       [](const InputSpec& s) { return open_inrimage(s.path); }},
      {"raw", "headerless samples, .raw", sniff_raw, open_raw_spec},
  };
}

std::unique_ptr<SampleSource> open_volume(const InputSpec& spec,
                                          std::span<const ReaderEntry> readers) {
  if (spec.path.empty()) throw InputError("the input has no path: name a volume file");
  const ReaderEntry& reader =
      spec.format == "auto" ? reader_by_probe(spec, readers) : reader_by_name(spec, readers);
  std::unique_ptr<SampleSource> source = reader.open(spec);
  if (spec.spacing || !spec.unit.empty())
    source = override_source(std::move(source), {.spacing = spec.spacing, .unit = spec.unit});
  if (spec.crop) source = crop_source(std::move(source), *spec.crop);
  return source;
}

std::unique_ptr<SampleSource> open_volume(const InputSpec& spec) {
  return open_volume(spec, builtin_readers());
}

}  // namespace voxweld
