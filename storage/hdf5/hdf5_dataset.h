// What a dataset says of itself: type, sizes, and how its samples are stored. Called under an
// Hdf5Lock.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/hdf5/hdf5_file.h"
#include "storage/types/sample_type.h"

namespace voxweld {

struct StoredType {
  std::string text;                  // "uint16", "float16", "compound" ...
  std::optional<SampleType> type{};  // as it is read; nothing where it is no number that is read
  std::endian order = std::endian::little;
  // In the file it is the bytes of `type` in `order`; else libhdf5 has to convert it.
  bool plain = false;
};
StoredType stored_type(hid_t type);

struct StoredFilter {
  int number = 0;
  std::string name;
  std::vector<unsigned> values;
};

enum class StorageKind : std::uint8_t { compact, contiguous, chunked, virtual_parts };

struct DatasetFacts {
  std::string path;
  StoredType type;
  std::vector<std::int64_t> dims;
  StorageKind storage = StorageKind::contiguous;
  std::vector<std::int64_t> chunk;    // of chunked ones, samples a dimension; may exceed dims
  std::vector<StoredFilter> filters;  // in the order of encoding
  std::vector<std::string> external;  // names of data files outside
  // The file that holds the dataset, which a link may have led to, and its size.
  std::string holder;
  std::uint64_t holder_bytes = 0;
};

// "dataset '/a' (3 x 4 x 5 uint16)" without the word: for lists.
std::string shape_text(const DatasetFacts& facts);
// Type and sizes alone; dims empty for a scalar or nothing.
DatasetFacts dataset_shape(hid_t dataset, const std::string& path);
// All of it. FormatError for what cannot be read: no numbers, virtual, absurd sizes, data in other
// files unless file.follow(), filters that are not here.
DatasetFacts dataset_facts(const Hdf5File& file, hid_t dataset, const std::string& path);

// One sample as it is in memory of what was never written.
std::vector<std::byte> fill_sample(hid_t dataset, hid_t memory_type, std::size_t bytes);
// The type by which libhdf5 gives samples of that type. Not to be closed, or to be: a handle.
Hdf5Handle memory_type(hid_t dataset, SampleType type);

}  // namespace voxweld
