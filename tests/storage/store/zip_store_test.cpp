// Arrays in zip files, made byte by byte.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "storage/store/open_zarr.h"
#include "storage/store/zip_store.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/storage/store/array_writers.h"
#include "tests/storage/store/zarr_reading.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::HasSubstr;
using testing::read_all;
using testing::refusal;
using testing::zip_of;
using testing::ZipForm;
using Members = std::vector<std::pair<std::string, std::string>>;

const std::vector<ZipForm> zip_forms = {
    {}, {.deflate = true}, {.zip64 = true}, {.deflate = true, .zip64 = true}, {.comment = "so"}};

std::string counting(std::size_t count) {
  std::string bytes(count, '\0');
  std::iota(bytes.begin(), bytes.end(), '\0');
  return bytes;
}

// 4 x 3 x 2 bytes, in two chunks, that count up; in a folder of the zip file.
Members members_of_array() {
  return {{"in/.zarray",
           R"({"zarr_format": 2, "shape": [2, 3, 4], "chunks": [1, 3, 4], "dtype": "|u1",
"order": "C", "compressor": null, "fill_value": 0, "filters": null, "dimension_separator": "."})"},
          {"in/0.0.0", counting(24).substr(0, 12)},
          {"in/1.0.0", counting(24).substr(12)}};
}

class MadeZip : public ::testing::Test {
 protected:
  std::filesystem::path path() const { return directory_ / "a.zarr.zip"; }
  void write(const std::string& bytes) const {
    write_whole_file(path(), as_bytes(bytes), Durability::rename_only);
  }
  const testing::TempDirectory directory_;
};

TEST_F(MadeZip, EveryFormIsRead) {
  std::vector<std::uint8_t> expected(24);
  std::iota(expected.begin(), expected.end(), std::uint8_t{0});
  for (const ZipForm& form : zip_forms) {
    write(zip_of(members_of_array(), form));
    const auto source = open_zarr(path());
    EXPECT_EQ(read_all<std::uint8_t>(*source), expected);
    ASSERT_EQ(source->info().files.size(), 1U);
    EXPECT_EQ(source->info().files[0].path, path().string());
    EXPECT_EQ(source->info().files[0].state.size, std::filesystem::file_size(path()));
  }
}

TEST_F(MadeZip, RangesFoldersAndNames) {
  Members members = members_of_array();
  members.push_back({"in/deep/er/x", "abc"});
  members.push_back({"in0", ""});
  members.push_back({"folder/", ""});
  for (const ZipForm& form : zip_forms) {
    write(zip_of(members, form));
    const auto store = zip_store(path());
    EXPECT_EQ(store->list("in"), (std::vector<std::string>{".zarray", "0.0.0", "1.0.0", "deep"}));
    EXPECT_EQ(store->list(""), (std::vector<std::string>{"in", "in0"}));
    EXPECT_TRUE(store->holds("in/deep") && store->holds("in/deep/er/x") && !store->holds("i"));
    EXPECT_EQ(store->open("in/deep", ObjectUse::whole), nullptr);
    EXPECT_EQ(store->open("in0", ObjectUse::whole)->size(), 0U);
    const auto object = store->open("in/1.0.0", ObjectUse::ranges);
    std::string part(5, ' ');
    object->read(4, std::as_writable_bytes(std::span(part)));
    EXPECT_EQ(part, counting(24).substr(16, 5));
    EXPECT_THROW(object->read(8, std::as_writable_bytes(std::span(part))), FormatError);
    EXPECT_THROW(object->read(~std::uint64_t{0}, std::as_writable_bytes(std::span(part))),
                 FormatError);
  }
}

// Cut anywhere, it is refused by its name.
TEST_F(MadeZip, CutFilesAreRefused) {
  for (const ZipForm& form : zip_forms) {
    const std::string whole = zip_of(members_of_array(), form);
    for (std::size_t size = 4; size < whole.size(); size += size + 120 < whole.size() ? 3 : 1) {
      write(whole.substr(0, size));
      ASSERT_NE(refusal(path()), "accepted") << size;
    }
  }
}

// Whatever byte is changed: an error, or the same samples, or chunks are missing.
TEST_F(MadeZip, ChangedBytesMakeNoWrongSamples) {
  for (const ZipForm& form : zip_forms) {
    const std::string whole = zip_of(members_of_array(), form);
    write(whole);
    const auto expected = read_all<std::uint8_t>(*open_zarr(path()));
    const std::size_t chunks = whole.find("in/0.0.0");
    for (std::size_t at = chunks; at < whole.size(); ++at)
      for (const int flip : {0xff, 0x01}) {
        std::string changed = whole;
        changed[at] = static_cast<char>(changed[at] ^ flip);
        write(changed);
        try {
          const auto values = read_all<std::uint8_t>(*open_zarr(path()));
          ASSERT_EQ(values.size(), expected.size());
          // A chunk whose name is another is missing, which is fill value.
          for (std::size_t i = 0; i < values.size(); ++i)
            ASSERT_TRUE(values[i] == expected[i] || values[i] == 0) << at;
        } catch (const Error& error) {
          ASSERT_EQ(error.exit_code(), 2) << error.what();
        }
      }
  }
}

TEST_F(MadeZip, SizesThatTheFileCannotHoldAreRefused) {
  const std::uint64_t huge = std::uint64_t{1} << 40;
  const auto patched = [&](const ZipForm& form, const std::string& mark, std::size_t at,
                           std::uint64_t value, std::size_t width) {
    std::string bytes = zip_of(members_of_array(), form);
    const std::size_t begin = bytes.rfind(mark);
    bytes.replace(begin + at, width, testing::number_bytes(value, width));
    write(bytes);
    return refusal(path());
  };
  const ZipForm deflated{.deflate = true};
  EXPECT_THAT(patched(deflated, "PK\1\2", 24, 0x7fffffff, 4), HasSubstr("cannot inflate to"));
  EXPECT_THAT(patched({}, "PK\1\2", 20, 0x7fffffff, 4), HasSubstr("the file has"));
  EXPECT_THAT(patched({}, "PK\1\2", 24, 7, 4), HasSubstr("a stored member of 7 bytes takes 12"));
  EXPECT_THAT(patched({}, "PK\1\2", 42, 0x7fffffff, 4), HasSubstr("said to be at byte"));
  EXPECT_THAT(patched({}, "PK\1\2", 8, 1, 2), HasSubstr("encrypted"));
  EXPECT_THAT(patched({}, "PK\1\2", 10, 93, 2), HasSubstr("method 93"));
  EXPECT_THAT(patched({}, "PK\5\6", 10, 9, 2), HasSubstr("members, 9 expected"));
  EXPECT_THAT(patched({}, "PK\5\6", 12, 0x7fffffff, 4), HasSubstr("list of members is said"));
  EXPECT_THAT(patched({.zip64 = true}, "PK\6\6", 48, huge, 8), HasSubstr("list of members"));
  EXPECT_THAT(patched({.zip64 = true}, "PK\6\7", 8, huge, 8), HasSubstr("zip64 record"));
}

}  // namespace
}  // namespace voxweld
