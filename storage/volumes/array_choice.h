// Which of several arrays of a file is the volume.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/types/volume_reader.h"

namespace voxweld {

struct FileArray {
  std::string selector;              // what input.dataset calls it
  std::string type_name;             // as the file has it
  std::optional<SampleType> type{};  // empty where it is none of ours
  std::int64_t components = 1;
  std::string place{};  // "at points": where it matters, for lists
};

// The index of the array of input.dataset, else `preferred`, else of the only one that can be read.
// Lists all in info.choices where there are several.
// InputError where several are left, and none of that name; FormatError where there is none at all,
// or the one has several values a sample, or values of a type that is none of ours.
std::size_t choose_array(const std::vector<FileArray>& arrays, std::optional<std::size_t> preferred,
                         const InputSpec& spec, VolumeInfo& info);

// The index of the only array that can be read, if there is one.
std::optional<std::size_t> only_readable(const std::vector<FileArray>& arrays);

}  // namespace voxweld
