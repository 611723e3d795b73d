#include "storage/store/zarr_metadata.h"

#include <fmt/format.h>

#include <system_error>

#include "storage/store/zarr_json.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

bool present(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

[[noreturn]] void refuse_directory(const fs::path& directory) {
  const std::string name = directory.string();
  const std::string expected = "; a Zarr array is a directory with a zarr.json or .zarray";
  std::error_code ignored;
  if (!present(directory)) throw InputError(name + ": no such directory" + expected);
  if (!fs::is_directory(directory, ignored)) throw InputError(name + ": is a file" + expected);
  if (present(directory / ".zgroup"))
    throw InputError(name +
                     ": is a group, not an array (.zgroup found); name the directory of an " +
                     "array inside it");
  if (present(directory / "attributes.json"))
    throw FormatError(name + ": N5 is not supported (attributes.json found, zarr.json expected)");
  throw InputError(name + ": no zarr.json or .zarray in it; name the directory of a Zarr array");
}

}  // namespace

ChunkForm ZarrArray::form() const {
  const std::size_t each = sample_bytes(type);
  return {static_cast<std::size_t>(chunk.x * chunk.y * chunk.z) * each, each};
}

Index3 ZarrArray::chunks_in_file() const {
  return divide(file, chunk);
}

std::uint64_t ZarrArray::index_bytes() const {
  const Index3 grid = chunks_in_file();
  return static_cast<std::uint64_t>(grid.x * grid.y * grid.z) * 16 +
         static_cast<std::uint64_t>(index.checksums) * 4;
}

double ZarrArray::files() const {
  const Index3 grid = divide(size + file - splat(1), file);
  return static_cast<double>(grid.x) * static_cast<double>(grid.y) * static_cast<double>(grid.z);
}

fs::path ZarrArray::file_path(Index3 at) const {
  std::string key = v2_keys ? "" : "c";
  for (const int axis : axes) {
    if (!key.empty()) key += separator;
    key += std::to_string(at[axis]);
  }
  return path / key;
}

bool holds_zarr_array(const fs::path& directory) {
  return present(directory / "zarr.json") || present(directory / ".zarray");
}

ZarrArray read_zarr_array(const fs::path& directory, const OmeDataset* image) {
  if (!holds_zarr_array(directory)) refuse_directory(directory);
  if (present(directory / "zarr.json"))
    return parse_zarr_array(read_text_file(directory / "zarr.json"), directory, image);
  return parse_zarr_v2_array(read_text_file(directory / ".zarray"), directory, image);
}

}  // namespace voxweld
