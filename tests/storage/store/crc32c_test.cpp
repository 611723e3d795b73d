#include "storage/store/crc32c.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "storage/support/file_io.h"

namespace voxweld {
namespace {

TEST(Crc32c, KnownValues) {  // RFC 3720, appendix B.4
  const std::vector<std::byte> zeros(32), ones(32, std::byte{0xff});
  for (const auto crc : {crc32c, crc32c_by_table}) {
    EXPECT_EQ(crc(as_bytes("")), 0U);
    EXPECT_EQ(crc(as_bytes("123456789")), 0xe3069283U);
    EXPECT_EQ(crc(zeros), 0x8a9136aaU);
    EXPECT_EQ(crc(ones), 0x62a8ab43U);
  }
}

TEST(Crc32c, BothPathsAgreeAtEveryLengthAndAlignment) {
  std::mt19937 random(1);
  std::vector<std::byte> data(300);
  for (std::byte& b : data) b = static_cast<std::byte>(random() & 0xff);
  for (std::size_t start = 0; start < 9; ++start)
    for (std::size_t size = 0; start + size <= data.size(); ++size) {
      const auto part = std::span(data).subspan(start, size);
      ASSERT_EQ(crc32c(part), crc32c_by_table(part)) << start << ", " << size;
    }
}

}  // namespace
}  // namespace voxweld
