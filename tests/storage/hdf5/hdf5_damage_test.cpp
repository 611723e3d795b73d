// Damaged HDF5 files: an error or sound samples, never a crash, a hang or memory without end.
#include "tests/storage/hdf5/hdf5_files.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;

class Hdf5Damage : public Hdf5Files {
 protected:
  std::string complaint_of(const Bytes& bytes) const {
    return complaint(write_file(folder_ / "damaged.h5", bytes));
  }
};

TEST_F(Hdf5Damage, CutShortAtEveryLength) {
  make({"chunked-gzip", "type-<u2", "nexus"});
  for (const char* name : {"chunked-gzip", "type-<u2", "nexus"}) {
    const Bytes whole = read_whole_file(path(name));
    for (std::size_t size = 0; size < whole.size(); size += size < 4096 ? 37 : 211) {
      const std::string said =
          complaint_of(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
      EXPECT_THAT(said, HasSubstr("damaged.h5")) << name << " " << size;
    }
  }
}

TEST_F(Hdf5Damage, ChunksWithChangedBytesAreNamed) {
  make({"chunked-fletcher", "chunked-gzip", "chunked-lzf"});
  for (const char* name : {"chunked-fletcher", "chunked-gzip", "chunked-lzf"}) {
    Bytes bytes = read_whole_file(path(name));
    // The chunks come last.
    for (std::size_t at = bytes.size() / 2; at < bytes.size(); at += 97)
      bytes[at] ^= std::byte{0x5a};
    expect_says(complaint_of(bytes),
                {"damaged.h5", "dataset '/data': the chunk at (", "get a sound copy"});
  }
}

// Bytes anywhere, one to three of them. What comes out of it may be sound or not.
TEST_F(Hdf5Damage, ChangedBytesAnywhere) {
  const std::vector<std::string> names = {"chunked-gzip", "chunked-latest", "tzyxc",      "several",
                                          "nexus",        "type-<u2",       "chunked-lzf"};
  make(names);
  std::mt19937_64 random(5);
  for (const std::string& name : names) {
    const Bytes whole = read_whole_file(path(name));
    for (int i = 0; i < 60; ++i) {
      Bytes bytes = whole;
      for (std::uint64_t n = 1 + random() % 3; n > 0; --n)
        bytes[static_cast<std::size_t>(random() % std::min<std::size_t>(bytes.size(), 6000))] =
            static_cast<std::byte>(random());
      complaint_of(bytes);  // fails the test where it is no error of ours
    }
  }
}

}  // namespace
}  // namespace voxweld::testing
