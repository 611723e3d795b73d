#include "storage/store/decompress.h"

#include <gmock/gmock.h>

#include <cstdint>
#include <string>
#include <vector>

namespace voxweld {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// What is said of an .lzma stream that ends behind its header.
std::string said_of_dictionary(std::uint32_t bytes, std::size_t samples) {
  std::vector<std::byte> encoded(18);
  encoded[0] = std::byte{0x5d};
  for (std::size_t i = 0; i < 4; ++i) encoded[1 + i] = static_cast<std::byte>(bytes >> (8 * i));
  std::vector<std::byte> out(samples);
  return decompress({.kind = CompressorKind::xz}, encoded, out);
}

TEST(Decompress, GivesADictionaryNoMoreThanSamplesAreWorth) {
  constexpr std::uint32_t mib = 1 << 20;
  EXPECT_THAT(said_of_dictionary(512 * mib, 4096), HasSubstr("asks for"));
  // The largest preset's, and that of a large chunk.
  EXPECT_THAT(said_of_dictionary(64 * mib, 4096), Not(HasSubstr("asks for")));
  EXPECT_THAT(said_of_dictionary(128 * mib, std::size_t{100} << 20), Not(HasSubstr("asks for")));
}

}  // namespace
}  // namespace voxweld
