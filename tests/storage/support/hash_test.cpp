#include "storage/support/hash.h"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <random>
#include <vector>

namespace voxweld {
namespace {

std::vector<std::byte> some_bytes(std::size_t count) {
  std::mt19937 random(17);
  std::vector<std::byte> bytes(count);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  return bytes;
}

TEST(Hash, FedInPiecesIsThatOfTheWhole) {
  std::mt19937 random(4);
  for (const std::size_t size : {0, 1, 16, 240, 241, 255, 256, 1024, 1025, 5000, 70000}) {
    const std::vector<std::byte> bytes = some_bytes(size);
    for (const std::size_t most : {std::size_t{7}, std::size_t{300}, size + 1}) {
      StreamHasher hasher;
      for (std::size_t at = 0; at < size;) {
        const std::size_t count = std::min(size - at, 1 + random() % most);
        hasher.update(std::span(bytes).subspan(at, count));
        at += count;
      }
      EXPECT_EQ(hasher.finish(), hash_bytes(bytes)) << size << " bytes, pieces up to " << most;
    }
  }
}

// In the widest vectors there are, and as the library has it.
TEST(Hash, IsThatOfTheLibrary) {
  for (std::size_t size = 0; size < 3000; size += 1 + size / 7) {
    const std::vector<std::byte> bytes = some_bytes(size);
    const XXH128_hash_t expected = XXH3_128bits(bytes.data(), size);
    EXPECT_EQ(hash_bytes(bytes), (Hash128{expected.low64, expected.high64})) << size;
  }
}

// Keys of work that is kept: other bytes would make all of it anew.
TEST(Hash, IsWhatItAlwaysWas) {
  EXPECT_EQ(to_hex(hash_bytes({})), "99aa06d3014798d86001c324468d497f");
  const std::string text = "voxweld";
  EXPECT_EQ(to_hex(KeyHasher().text(text).integer(-1).real(0.5).finish()),
            "420a34b03056210949e62f8aa900f761");
}

}  // namespace
}  // namespace voxweld
