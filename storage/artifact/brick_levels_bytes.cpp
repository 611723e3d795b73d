#include "storage/artifact/brick_levels_bytes.h"

#include <cstring>
#include <type_traits>

#include "storage/artifact/container.h"

namespace voxweld {
namespace {

// Written as they lie in memory.
static_assert(sizeof(KeptCluster) == 36 && sizeof(BlockMerge) == 8 &&
              std::is_trivially_copyable_v<KeptCluster> &&
              std::is_trivially_copyable_v<BlockMerge>);

template <class T>
void put_values(const std::vector<T>& values, std::vector<std::byte>& out) {
  const auto bytes = as_section(values);
  out.insert(out.end(), bytes.begin(), bytes.end());
}

template <class T>
void take_values_of(std::span<const std::byte>& bytes, std::size_t count, std::vector<T>& values) {
  values.resize(count);
  if (count > 0) std::memcpy(static_cast<void*>(values.data()), bytes.data(), count * sizeof(T));
  bytes = bytes.subspan(count * sizeof(T));
}

}  // namespace

void put_levels(const BrickLevels& levels, std::vector<std::byte>& out) {
  put_values(levels.errors, out);
  put_values(levels.parents, out);
  put_values(levels.clusters, out);
  put_values(levels.merges, out);
}

BrickLevels levels_of(std::span<const std::byte> bytes, const LevelsSize& size) {
  BrickLevels levels;
  take_values_of(bytes, size.vertices, levels.errors);
  take_values_of(bytes, size.vertices, levels.parents);
  take_values_of(bytes, size.clusters, levels.clusters);
  take_values_of(bytes, size.merges, levels.merges);
  return levels;
}

}  // namespace voxweld
