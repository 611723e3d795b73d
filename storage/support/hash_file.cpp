#include "storage/support/hash_file.h"

#include <algorithm>

namespace voxweld {

Hash128 hash_file(const ReadFile& file, const std::function<void()>& between) {
  StreamHasher hasher;
  std::vector<std::byte> piece(std::size_t{1} << 20);
  for (std::uint64_t at = 0; at < file.size();) {
    if (between) between();
    const auto part =
        std::span(piece).first(std::min<std::uint64_t>(piece.size(), file.size() - at));
    file.read(at, part);
    hasher.update(part);
    at += part.size();
  }
  return hasher.finish();
}

}  // namespace voxweld
