#include "storage/hdf5/hdf5_dataset.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "storage/hdf5/chunk_filters.h"
#include "storage/hdf5/hdf5_attributes.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// The product of the sizes times 8 bytes stays within 62 bits.
constexpr std::int64_t most_samples = std::int64_t{1} << 59;
constexpr std::uint64_t most_chunk_bytes = std::uint64_t{1} << 30;

// Nothing where the product is too large.
std::optional<std::int64_t> product(const std::vector<std::int64_t>& dims) {
  std::int64_t all = 1;
  for (const std::int64_t side : dims) {
    if (side < 0 || (side > 0 && all > most_samples / side)) return {};
    all *= side;
  }
  return all;
}

StorageKind storage_kind(hid_t created) {
  switch (H5Pget_layout(created)) {
    case H5D_COMPACT:
      return StorageKind::compact;
    case H5D_CHUNKED:
      return StorageKind::chunked;
    case H5D_VIRTUAL:
      return StorageKind::virtual_parts;
    default:
      return StorageKind::contiguous;
  }
}

std::vector<StoredFilter> filters_of(hid_t created, const std::string& where) {
  std::vector<StoredFilter> filters;
  const int count = H5Pget_nfilters(created);
  for (unsigned i = 0; i < static_cast<unsigned>(std::max(0, count)); ++i) {
    std::size_t values = 32;
    StoredFilter filter;
    filter.values.resize(values);
    unsigned flags = 0, config = 0;
    char name[128] = {};
    filter.number = H5Pget_filter2(created, i, &flags, &values, filter.values.data(), sizeof name,
                                   name, &config);
    if (filter.number < 0) fail_hdf5(where, "its filters cannot be read");
    filter.values.resize(std::min(values, filter.values.size()));
    name[sizeof name - 1] = '\0';
    filter.name = name;
    filters.push_back(std::move(filter));
  }
  return filters;
}

std::vector<std::string> external_files(hid_t created) {
  std::vector<std::string> names;
  const int count = H5Pget_external_count(created);
  for (unsigned i = 0; i < static_cast<unsigned>(std::max(0, count)); ++i) {
    char name[4096] = {};
    off_t offset = 0;
    hsize_t bytes = 0;
    if (H5Pget_external(created, i, sizeof name - 1, name, &offset, &bytes) >= 0)
      names.emplace_back(name);
  }
  return names;
}

void check_filters(const DatasetFacts& facts, const std::string& where) {
  if (decodes_chunks(facts.filters)) return;
  for (const StoredFilter& filter : facts.filters) {
    unsigned config = 0;
    if (H5Zfilter_avail(filter.number) > 0 && H5Zget_filter_info(filter.number, &config) >= 0 &&
        (config & H5Z_FILTER_CONFIG_DECODE_ENABLED) != 0)
      continue;
    throw FormatError(fmt::format(
        "{}: its chunks are encoded by the filter {} (number {}), which libhdf5 does not have "
        "here: "
        "install its plug-in and name the folder in HDF5_PLUGIN_PATH, or encode the dataset anew: "
        "h5repack -f GZIP=5",
        where, filter.name.empty() ? "without a name" : "'" + filter.name + "'", filter.number));
  }
}

void check_chunk(const DatasetFacts& facts, const std::string& where) {
  const auto samples = product(facts.chunk);
  const std::uint64_t most = most_chunk_bytes / sample_bytes(*facts.type.type);
  if (facts.chunk.size() == facts.dims.size() && samples && *samples > 0 &&
      static_cast<std::uint64_t>(*samples) <= most)
    return;
  throw FormatError(
      fmt::format("{}: its chunks are of {} samples: expected sizes of 1 and more in each of {} "
                  "dimensions, {} samples at most; encode it anew by h5repack -l CHUNK=64x64x64",
                  where, fmt::join(facts.chunk, " x "), facts.dims.size(), most));
}

// The file that the dataset lies in, and that it can hold what is said to be stored.
void check_holder(hid_t dataset, const std::string& where, DatasetFacts& facts) {
  char holder[4096] = {};
  if (H5Fget_name(dataset, holder, sizeof holder - 1) <= 0)
    fail_hdf5(where, "the file that holds it is not known");
  facts.holder = holder;
  const auto state = file_state(facts.holder);
  facts.holder_bytes = state ? state->size : 0;
  if (!facts.external.empty()) return;
  if (const hsize_t bytes = H5Dget_storage_size(dataset); facts.holder_bytes < bytes)
    throw FormatError(fmt::format(
        "{}: its header speaks of {} stored bytes, but the file has {}: get a complete copy", where,
        bytes, facts.holder_bytes));
}

}  // namespace

std::string shape_text(const DatasetFacts& facts) {
  return fmt::format("{} ({} {})", facts.path, fmt::join(facts.dims, " x "), facts.type.text);
}

DatasetFacts dataset_shape(hid_t dataset, const std::string& path) {
  DatasetFacts facts;
  facts.path = path;
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose), space(H5Dget_space(dataset), H5Sclose);
  if (type) facts.type = stored_type(type.get());
  if (space)
    for (const hsize_t side : space_dims(space.get()).value_or(std::vector<hsize_t>{}))
      facts.dims.push_back(
          static_cast<std::int64_t>(std::min<hsize_t>(side, std::uint64_t{1} << 62)));
  return facts;
}

DatasetFacts dataset_facts(const Hdf5File& file, hid_t dataset, const std::string& path) {
  const std::string where = file.where("dataset", path);
  DatasetFacts facts = dataset_shape(dataset, path);
  if (!facts.type.type)
    throw FormatError(fmt::format(
        "{}: its samples are {}: expected integers of 8 to 64 bits or floats of 16, 32 or 64 bits",
        where, facts.type.text));
  const auto samples = product(facts.dims);
  if (facts.dims.empty() || !samples || *samples == 0)
    throw FormatError(fmt::format(
        "{}: its sizes are {}: expected three dimensions with samples, {} samples at most", where,
        facts.dims.empty() ? "those of a single value"
                           : fmt::format("{}", fmt::join(facts.dims, " x ")),
        most_samples));
  const Hdf5Handle created(H5Dget_create_plist(dataset), H5Pclose);
  if (!created) fail_hdf5(where, "how it is stored cannot be read");
  facts.storage = storage_kind(created.get());
  if (facts.storage == StorageKind::virtual_parts)
    throw FormatError(fmt::format(
        "{}: a virtual dataset, put together of other datasets, and often of other files: copy it "
        "into one, with h5py: out['a'] = f['{}'][:]",
        where, path));
  facts.external = external_files(created.get());
  if (!facts.external.empty() && !file.follow())
    throw FormatError(fmt::format(
        "{}: its samples lie in the file '{}' outside: set input.follow = true (--follow) if that "
        "is to be read",
        where, facts.external.front()));
  facts.filters = filters_of(created.get(), where);
  if (facts.storage == StorageKind::chunked) {
    hsize_t chunk[H5S_MAX_RANK];
    const int rank = H5Pget_chunk(created.get(), H5S_MAX_RANK, chunk);
    for (int i = 0; i < rank; ++i) facts.chunk.push_back(static_cast<std::int64_t>(chunk[i]));
    check_chunk(facts, where);
    check_filters(facts, where);
  }
  check_holder(dataset, where, facts);
  return facts;
}

std::vector<std::byte> fill_sample(hid_t dataset, hid_t memory, std::size_t bytes) {
  std::vector<std::byte> sample(bytes);
  const Hdf5Handle created(H5Dget_create_plist(dataset), H5Pclose);
  H5D_fill_value_t defined = H5D_FILL_VALUE_UNDEFINED;
  if (H5Pfill_value_defined(created.get(), &defined) < 0 || defined == H5D_FILL_VALUE_UNDEFINED)
    return sample;
  if (H5Pget_fill_value(created.get(), memory, sample.data()) < 0)
    std::ranges::fill(sample, std::byte{});
  return sample;
}

}  // namespace voxweld
