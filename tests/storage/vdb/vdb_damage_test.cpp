// Damaged .vdb files: an error or sound samples, never a crash, a hang or memory without end.
#include <ctime>

#include "tests/storage/vdb/vdb_files.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;

namespace io = openvdb::io;

class VdbDamage : public VdbFiles {
 protected:
  std::string said_of(std::span<const std::byte> bytes) const {
    return complaint(write_file(folder_ / "damaged.vdb", bytes));
  }
  // Small and of several leaves.
  Bytes sound(std::uint32_t compression) const {
    auto ball = level_set_ball(6);
    return read_whole_file(write("sound", {ball}, compression));
  }
};

TEST_F(VdbDamage, CutShortAtEveryLength) {
  const Bytes whole = sound(io::COMPRESS_BLOSC | io::COMPRESS_ACTIVE_MASK);
  for (std::size_t size = 0; size < whole.size(); size += size < 1500 ? 61 : whole.size() / 60)
    EXPECT_THAT(said_of(std::span(whole).first(size)), HasSubstr("damaged.vdb")) << size;
  EXPECT_THAT(said_of(std::span(whole).first(whole.size() - 1)), HasSubstr("truncated: its grids"));
}

TEST_F(VdbDamage, NoVdbAtAll) {
  expect_says(complaint(write_file(folder_ / "text.vdb", "this is no file of voxels at all")),
              {"text.vdb", "opening it", "OpenVDB"});
  expect_says(complaint(write_file(folder_ / "empty.vdb", "")), {"empty.vdb"});
  expect_says(complaint(folder_ / "missing.vdb"), {"missing.vdb", "no such file"});
}

TEST_F(VdbDamage, ChangedBytesAnywhere) {
  std::mt19937_64 random(5);
  for (const std::uint32_t flags : {std::uint32_t{io::COMPRESS_NONE},
                                    std::uint32_t{io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK},
                                    std::uint32_t{io::COMPRESS_BLOSC | io::COMPRESS_ACTIVE_MASK}}) {
    const Bytes whole = sound(flags);
    for (int i = 0; i < 40; ++i) {
      Bytes bytes = whole;
      // Half of them where the headers and the upper nodes are.
      const std::size_t range =
          i % 2 == 0 ? std::min<std::size_t>(2500, whole.size()) : whole.size();
      for (std::uint64_t n = 1 + random() % 3; n > 0; --n)
        bytes[static_cast<std::size_t>(random() % range)] = static_cast<std::byte>(random());
      // Of the processor: on a busy machine a minute passes soon.
      const std::clock_t begin = std::clock();
      said_of(bytes);  // fails the test where it is no error of ours
      EXPECT_LT((std::clock() - begin) / CLOCKS_PER_SEC, 60) << flags << " " << i;
    }
  }
}

// Of zlib's OpenVDB ignores the checksum.
TEST_F(VdbDamage, SamplesThatCannotBeDecodedAreNamed) {
  Bytes bytes = sound(io::COMPRESS_BLOSC | io::COMPRESS_ACTIVE_MASK);
  // The leaves' values come last.
  for (std::size_t at = bytes.size() * 3 / 4; at < bytes.size(); at += 20)
    bytes[at] = static_cast<std::byte>(0x5a);
  expect_says(said_of(bytes), {"damaged.vdb: the voxels from (", "OpenVDB: ", "sound copy"});
}

// A voxel far off makes a box that no volume has.
TEST_F(VdbDamage, AnAbsurdBoxIsToldInFigures) {
  auto grid = openvdb::FloatGrid::create(0.0F);
  grid->setName("a");
  grid->tree().setValue(openvdb::Coord(-2000000000), 1.0F);
  grid->tree().setValue(openvdb::Coord(2000000000), 1.0F);
  expect_says(complaint(write("far", {grid})),
              {"grid 'a'", "(-2000000000, -2000000000, -2000000000)", "4000000003", "clip"});
}

}  // namespace
}  // namespace voxweld::testing
