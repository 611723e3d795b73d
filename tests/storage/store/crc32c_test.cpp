#include "storage/store/crc32c.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "storage/support/file_io.h"

namespace voxweld {

// The product's own source, compiled as for a processor without the instruction (CMakeLists.txt).
std::uint32_t crc32c_by_tables(std::span<const std::byte> data);

namespace {

constexpr auto paths = {crc32c, crc32c_by_tables};

// As it is defined: bit by bit.
std::uint32_t reference(std::span<const std::byte> data) {
  std::uint32_t crc = 0xffffffff;
  for (const std::byte byte : data) {
    crc ^= static_cast<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0x82f63b78 : 0);
  }
  return ~crc;
}

TEST(Crc32c, KnownValues) {  // RFC 3720, appendix B.4
  const std::vector<std::byte> zeros(32), ones(32, std::byte{0xff});
  for (const auto crc : paths) {
    EXPECT_EQ(crc(as_bytes("")), 0U);
    EXPECT_EQ(crc(as_bytes("123456789")), 0xe3069283U);
    EXPECT_EQ(crc(zeros), 0x8a9136aaU);
    EXPECT_EQ(crc(ones), 0x62a8ab43U);
  }
}

TEST(Crc32c, AnyLengthAndAlignmentAsDefined) {
  std::mt19937 random(1);
  std::vector<std::byte> data(300);
  for (std::byte& b : data) b = static_cast<std::byte>(random() & 0xff);
  for (std::size_t start = 0; start < 9; ++start)
    for (std::size_t size = 0; start + size <= data.size(); ++size) {
      const auto part = std::span(data).subspan(start, size);
      for (const auto crc : paths) ASSERT_EQ(crc(part), reference(part)) << start << ", " << size;
    }
}

}  // namespace
}  // namespace voxweld
