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

[[noreturn]] void refuse_folder(const StoreFolder& folder) {
  const std::string name = folder.name();
  const std::string expected = "; a Zarr array is a directory with a zarr.json or .zarray";
  if (!folder.holds("")) throw InputError(name + ": no such directory" + expected);
  std::error_code ignored;
  const auto path = folder.file_of("");
  if (path && !fs::is_directory(*path, ignored)) throw InputError(name + ": is a file" + expected);
  if (folder.holds(".zgroup"))
    throw InputError(name +
                     ": is a group, not an array (.zgroup found); name the directory of an " +
                     "array inside it");
  throw InputError(name + ": no zarr.json or .zarray in it; name the directory of a Zarr array");
}

}  // namespace

Index3 ZarrArray::axes_of(const Extents& extents) const {
  Index3 result = splat(1);
  for (std::size_t d = 0; d < axes.size(); ++d)
    if (axes[d] >= 0) result[axes[d]] = extents[d];
  return result;
}

std::size_t ZarrArray::stored_bytes() const {
  return half ? 2 : sample_bytes(type);
}

ChunkForm ZarrArray::form() const {
  std::size_t bytes = stored_bytes();
  for (const std::int64_t extent : chunk) bytes *= static_cast<std::size_t>(extent);
  return {bytes, stored_bytes()};
}

const Extents& ZarrArray::piece(std::size_t level) const {
  return level == 0 ? file : shards[level - 1].chunk;
}

Extents ZarrArray::pieces_in(std::size_t level) const {
  Extents grid = piece(level);
  for (std::size_t d = 0; d < grid.size(); ++d) grid[d] /= piece(level + 1)[d];
  return grid;
}

std::uint64_t ZarrArray::index_bytes(std::size_t level) const {
  std::uint64_t entries = 1;
  for (const std::int64_t count : pieces_in(level)) entries *= static_cast<std::uint64_t>(count);
  return entries * 16 + static_cast<std::uint64_t>(shards[level].index.checksums) * 4;
}

double ZarrArray::files() const {
  const Index3 each = axes_of(file), grid = divide(size + each - splat(1), each);
  return static_cast<double>(grid.x) * static_cast<double>(grid.y) * static_cast<double>(grid.z);
}

std::string ZarrArray::file_key(Index3 file_index) const {
  std::string key = keys.leading_c ? "c" : "";
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::size_t d = keys.fastest_first ? axes.size() - 1 - i : i;
    if (!key.empty()) key += keys.separator;
    key += std::to_string(axes[d] >= 0 ? file_index[axes[d]] : at[d] / file[d]);
  }
  return key;
}

fs::path ZarrArray::file_path(Index3 file_index) const {
  return path / file_key(file_index);
}

bool holds_zarr_array(const fs::path& directory) {
  return present(directory / "zarr.json") || present(directory / ".zarray");
}

ZarrArray read_zarr_array(const StoreFolder& folder, const ArrayContext& context) {
  if (const auto text = folder.text("zarr.json"))
    return parse_zarr_array(*text, folder.name(), context);
  const auto text = folder.text(".zarray");
  if (!text) refuse_folder(folder);
  return parse_zarr_v2_array(*text, folder.name(), context);
}

ZarrArray read_zarr_array(const fs::path& directory) {
  return read_zarr_array(StoreFolder(folder_store(directory)), {});
}

}  // namespace voxweld
