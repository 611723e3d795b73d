// What a reader of volumes is: a row of the table in storage/readers, and what it is handed.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "storage/types/input_selection.h"
#include "storage/types/volume.h"

namespace voxweld {

// What a headerless file does not say about itself.
struct RawPieces {
  std::optional<Index3> size{};  // samples along x (fastest), y, z
  std::optional<SampleType> type{};
  std::endian byte_order = std::endian::little;
  std::int64_t header_bytes = 0;  // before the samples; -1: the samples end the file
};

struct InputSpec {
  std::string path;             // file, directory or pattern, as its reader takes it
  std::string format = "auto";  // or a reader's name
  RawPieces raw{};
  std::optional<Box3> crop{};     // samples to keep, half-open, in the file's own indices
  std::optional<Vec3> spacing{};  // replaces what the file says; positive
  // Headers may name data files anywhere, not only in their own folder and below.
  bool follow = false;
  std::string unit{};  // when given, renames the unit of spacing and origin, converts nothing
  InputSelection select{};
  Resample resample = Resample::none;
  // For showing what there is: where `select` leaves a choice open, the reader opens the first, and
  // says so in info().warnings.
  bool survey = false;
};

// What detection looks at, read once.
struct InputProbe {
  std::filesystem::path path;
  std::string extension{};  // lower case with its dot; of "a.nii.gz" it is ".nii.gz"
  bool is_file = false;     // else a directory, a pattern, or nothing there
  bool is_directory = false;
  std::vector<std::byte> head{};           // the first bytes of a file, at most 4 KiB
  std::vector<std::byte> inflated_head{};  // the same after decompression, where it is gzip
};

enum class Match : std::uint8_t { none, extension, contents };

struct VolumeReader {
  std::string name;   // what InputSpec::format calls it
  std::string files;  // for messages: ".nrrd, .nhdr"
  // How sure the reader is that the input is its own: by contents, by name only, or not at all.
  std::function<Match(const InputProbe&)> test;
  // Opens the input, without crop and overrides. Throws FormatError, InputError or StorageError.
  // Empty where `module` is not.
  std::function<std::unique_ptr<SampleSource>(const InputSpec&)> open{};
  // The module that opens the input, loaded when there is one to open; empty: built in.
  std::string module{};
  // What that module is built with, for the message where it is missing.
  std::string library{};
  // What of InputSpec::select it looks at. open_volume refuses the rest.
  std::vector<Selector> selects{};
  bool resamples = false;  // looks at InputSpec::resample
};

}  // namespace voxweld
