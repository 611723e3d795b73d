// What a look at a file may take is bounded by the file, not by what its header claims.
#include <fmt/format.h>

#include "tests/pipeline/cli/workplace.h"
#include "tests/support/deflated.h"

namespace voxweld::testing {
namespace {

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string zarr_json(const std::string& shape, const std::string& chunk) {
  return fmt::format(
      R"({{"zarr_format":3,"node_type":"array","shape":{},"data_type":"uint8","chunk_grid":)"
      R"({{"name":"regular","configuration":{{"chunk_shape":{}}}}},"chunk_key_encoding":)"
      R"({{"name":"default"}},"fill_value":0,"codecs":[{{"name":"bytes"}},{{"name":"gzip"}}]}})",
      shape, chunk);
}

TEST(InfoBounds, ANiftiThatClaimsMoreThanItsBytesHoldIsRefusedUnread) {
  const Workplace place;
  std::string header(352, '\0');
  const auto put = [&](std::size_t at, std::initializer_list<int> values) {
    for (const int value : values) {
      header[at++] = static_cast<char>(value & 255);
      header[at++] = static_cast<char>(value >> 8 & 255);
    }
  };
  put(0, {348, 0});
  put(40, {3, 32767, 32767, 32767});
  put(70, {2, 8});
  header.replace(344, 4, std::string("n+1\0", 4));
  const std::string whole = header + std::string(100000, '\0');
  write_bytes(place.at("a.nii.gz"),
              text_of(deflated(std::as_bytes(std::span(whole)), Wrapper::gzip)));
  expect_refused({"info", "--check", place.at("a.nii.gz")}, {"a.nii.gz: truncated"});
}

TEST(InfoBounds, AZarrThatNoScanWouldEndIsRefused) {
  const Workplace place;
  const std::string array = place.at("a.zarr");
  std::filesystem::create_directory(array);
  write_bytes(array + "/zarr.json", zarr_json("[1099511627776,4,4]", "[32,4,4]"));
  expect_refused({"info", "--check", array, "--log-level", "quiet"}, {"a.zarr", "524287 a side"});
  expect_refused({"init", array, "--log-level", "quiet", "-o", place.at("a.toml")},
                 {"524287 a side"});
  write_bytes(array + "/zarr.json", zarr_json("[524287,524287,524287]", "[64,64,64]"));
  expect_refused({"info", "--check", array, "--log-level", "quiet"},
                 {"a.zarr", "of which 0 are there"});
  place.run({"info", array});  // its facts take no time
  // What is small is filled, as Zarr has it.
  write_bytes(array + "/zarr.json", zarr_json("[64,64,64]", "[64,64,64]"));
  EXPECT_EQ(place.info(array, {"--check"}).at("values").at("samples"), 64 * 64 * 64);
}

TEST(InfoBounds, AZarrChunkTooSmallForWhatItDecodesToIsRefusedUnread) {
  const Workplace place;
  const std::string array = place.at("a.zarr");
  std::filesystem::create_directories(array + "/c/0/0");
  write_bytes(array + "/zarr.json", zarr_json("[8192,8192,8192]", "[8192,8192,8192]"));
  write_bytes(array + "/c/0/0/0", std::string(1000, 'x'));
  expect_refused({"info", "--check", array, "--log-level", "quiet"},
                 {"its chunk has 1000 bytes", "549755813888"});
}

// Smaller chunks of the store would not help where those of the input are large.
TEST(InfoBounds, RunSaysWhatMemoryTheChunksOfAZarrTake) {
  const Workplace place;
  std::filesystem::create_directories(place.at("large.zarr"));
  write_bytes(place.at("large.zarr/.zarray"),
              R"({"zarr_format": 2, "shape": [8, 4096, 4096], "chunks": [4, 4096, 4096],
                  "dtype": "<u2", "compressor": {"id": "zlib", "level": 1}, "fill_value": 0,
                  "order": "C", "filters": null})");
  write_bytes(place.at("large.toml"),
              "[input]\npath = \"large.zarr\"\n[surface]\nisovalue = 5\n"
              "[run]\nmemory = \"300MiB\"\n");
  expect_refused({"run", place.at("large.toml"), "--log-level", "quiet"},
                 {"run.memory = 300MiB is too small", "stage ingest needs at least",
                  "the input, of which a piece takes 288.1 MiB to decode", "rewrite the input"});
}

}  // namespace
}  // namespace voxweld::testing
