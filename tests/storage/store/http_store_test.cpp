// Arrays on a server: the loopback interface, with and without byte ranges, and with hiccups.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <nlohmann/json.hpp>

#include "storage/readers/open_volume.h"
#include "storage/store/http_store.h"
#include "storage/store/shard_writer.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/storage/http/http_server.h"
#include "tests/storage/store/memory_source.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::AllOf;
using testing::error_text;
using ::testing::HasSubstr;
using testing::HttpServer;
using testing::MemorySource;
using testing::TempDirectory;

std::string answer_of(const std::filesystem::path& file) {
  const auto bytes = read_whole_file(file);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Serves the files of a folder.
class HttpArrays : public ::testing::Test {
 protected:
  HttpArrays() {
    server_.server().Get("/.*", [this](const httplib::Request& request, httplib::Response& answer) {
      ++asked_;
      if (hiccups_ && asked_ % 5 == 0) {
        answer.status = 503;
        return;
      }
      if (!token_.empty() && request.get_param_value("token") != token_) {
        answer.status = 403;
        return;
      }
      const auto file = folder_ / request.path.substr(1);
      if (!std::filesystem::is_regular_file(file)) {
        answer.status = 404;
        return;
      }
      if (!ranges_) const_cast<httplib::Request&>(request).ranges.clear();
      answer.set_content(answer_of(file), "application/octet-stream");
    });
    server_.start();
  }
  // A sharded Zarr v3 array, as our own brick store is one.
  MemorySource write_store(const std::string& name) const {
    const MemorySource source = testing::random_source(SampleType::u16, {50, 40, 30}, 3);
    StoreLayout layout;
    layout.array = folder_ / name;
    layout.records = folder_ / "records";
    layout.type = SampleType::u16;
    layout.geometry.size = {50, 40, 30};
    layout.geometry.spacing = {0.5, 1, 2};
    layout.parameters = {.chunk = 8, .shard = 32};
    write_store_metadata(layout);
    HistogramStatistics statistics(layout.type);
    ShardScratch scratch;
    for (std::int64_t y = 0; y < 2; ++y)
      for (std::int64_t x = 0; x < 2; ++x)
        write_shard(layout, {x, y, 0}, Hash128{}, source, statistics, scratch);
    return source;
  }
  void expect_equal(const SampleSource& a, const MemorySource& b) const {
    for (const Box3& box : {b.all(), Box3{{7, 9, 3}, {41, 17, 29}}})
      EXPECT_EQ(testing::read_box(a, box), testing::read_box(b, box));
  }
  HttpServer server_;
  TempDirectory folder_;
  std::atomic<int> asked_ = 0;
  std::atomic<bool> hiccups_ = false, ranges_ = true;
  std::string token_;
};

TEST_F(HttpArrays, GiveTheSamplesOfTheFolder) {
  const MemorySource source = write_store("a.zarr");
  const auto volume = open_volume({.path = server_.url("/a.zarr")});
  EXPECT_EQ(volume->info().format, "zarr");
  EXPECT_EQ(volume->info().geometry.spacing, (Vec3{0.5, 1, 2}));
  ASSERT_EQ(volume->info().files.size(), 1U);
  EXPECT_EQ(volume->info().files[0].path, server_.url("/a.zarr/zarr.json"));
  expect_equal(*volume, source);
}

// A hundred and forty chunks, twice, in four files.
TEST_F(HttpArrays, ChunksAreNotAskedForOneByOne) {
  const MemorySource source = write_store("a.zarr");
  const auto volume = open_volume({.path = server_.url("/a.zarr")});
  asked_ = 0;
  expect_equal(*volume, source);
  EXPECT_LE(asked_, 4 * 3);
}

TEST_F(HttpArrays, WithoutByteRangesToo) {
  const MemorySource source = write_store("a.zarr");
  ranges_ = false;
  expect_equal(*open_volume({.path = server_.url("/a.zarr/")}), source);
}

TEST_F(HttpArrays, ThroughHiccups) {
  const MemorySource source = write_store("a.zarr");
  hiccups_ = true;
  expect_equal(*open_volume({.path = server_.url("/a.zarr")}), source);
}

TEST_F(HttpArrays, MissingPiecesAreFillValues) {
  write_store("a.zarr");
  std::filesystem::remove_all(folder_ / "a.zarr/c");
  const auto volume = open_volume({.path = server_.url("/a.zarr")});
  for (const std::byte b : testing::read_box(*volume, {{0, 0, 0}, {50, 40, 30}}))
    ASSERT_EQ(b, std::byte{0});
}

TEST_F(HttpArrays, AQueryGoesWithEveryRequest) {
  const MemorySource source = write_store("a.zarr");
  token_ = "k=1";
  expect_equal(*open_volume({.path = server_.url("/a.zarr?token=k%3D1")}), source);
  EXPECT_THAT(error_text<InputError>([&] { open_volume({.path = server_.url("/a.zarr")}); }),
              AllOf(HasSubstr("/a.zarr"), HasSubstr("status 403")));
}

TEST_F(HttpArrays, SayWhatIsNotThere) {
  EXPECT_THAT(error_text<InputError>([&] { open_volume({.path = server_.url("/b.zarr?x")}); }),
              AllOf(HasSubstr("/b.zarr?x: the server has no zarr.json"), HasSubstr("download")));
}

TEST_F(HttpArrays, NamesAreEscaped) {
  std::filesystem::create_directories(folder_ / "a b");
  std::ofstream(folder_ / "a b/c#d") << "text";
  const auto store = http_store(server_.url("/a%20b"));
  const auto object = store->open("c#d", ObjectUse::whole);
  ASSERT_TRUE(object);
  EXPECT_EQ(object->size(), 4U);
  EXPECT_EQ(store->open("c", ObjectUse::ranges), nullptr);
}

}  // namespace
}  // namespace voxweld
