// Which array of a folder or zip file is the volume: arrays, pyramids of them, and groups of both.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "storage/store/byte_store.h"
#include "storage/store/zarr_metadata.h"
#include "storage/types/volume_reader.h"

namespace voxweld {

enum class ArrayFamily : std::uint8_t { zarr, n5 };

struct ForeignArray {
  ZarrArray array;     // its choices and warnings are moved to those below
  StoreFolder folder;  // that the array lies in
  std::vector<InputChoice> choices;
  std::vector<std::string> warnings;
};

// What spec.path and spec.select name. InputError where that leaves a choice open (but for a survey)
// or chooses what is not there; FormatError for what is damaged or not supported.
ForeignArray find_foreign_array(const InputSpec& spec, ArrayFamily family);

// The folder, what the zip file at the path holds, or what lies at the address of a server.
std::shared_ptr<const ByteStore> open_byte_store(const std::string& path);

// What find_foreign_array reads: the array that `name` of `format` ("zarr", "n5") is.
ZarrArray read_foreign_array(const InputSpec& spec, const std::string& format);

}  // namespace voxweld
