// A run whose input lies on a server.
#include <fstream>

#include "tests/pipeline/cli/workplace.h"
#include "tests/storage/http/http_server.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;

// A Zarr v2 array of one byte a sample: a ball, in chunks without compression.
void write_ball(const Workplace& place, const std::string& name) {
  std::filesystem::create_directories(place.at(name));
  write_bytes(place.at(name + "/.zarray"),
              R"({"zarr_format": 2, "shape": [24, 24, 24], "chunks": [16, 16, 16],
                  "dtype": "|u1", "compressor": null, "fill_value": 0, "order": "C",
                  "filters": null})");
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        std::string chunk;
        for (int z = 16 * k; z < 16 * k + 16; ++z)
          for (int y = 16 * j; y < 16 * j + 16; ++y)
            for (int x = 16 * i; x < 16 * i + 16; ++x) {
              const int d = (x - 12) * (x - 12) + (y - 12) * (y - 12) + (z - 12) * (z - 12);
              chunk.push_back(static_cast<char>(std::max(0, 250 - 2 * d)));
            }
        write_bytes(place.at(name + "/" + std::to_string(k) + "." + std::to_string(j) + "." +
                             std::to_string(i)),
                    chunk);
      }
}

TEST(ServerInput, GivesTheMeshThatTheFolderGives) {
  const Workplace place;
  write_ball(place, "ball.zarr");
  HttpServer server;
  server.server().set_mount_point("/", place.at(""));
  server.start();
  const std::string url = server.url("/ball.zarr");
  EXPECT_EQ(place.info(url)["format"], "zarr");
  place.run({"init", url, "-o", place.at("far.toml")});
  EXPECT_THAT(read_bytes(place.at("far.toml")), HasSubstr("path = \"" + url + "\""));
  place.run({"run", place.at("far.toml")});
  place.run({"init", place.at("ball.zarr"), "-o", place.at("near.toml")});
  place.run({"run", place.at("near.toml")});
  EXPECT_EQ(read_bytes(place.at("far.mesh/mesh.drc")), read_bytes(place.at("near.mesh/mesh.drc")));
  place.run({"verify", place.at("far.mesh")});
  // What was fetched is there: with another isovalue nothing is fetched again.
  const ProgramResult again =
      place.run({"run", place.at("far.toml"), "--set", "surface.isovalue=150"});
  EXPECT_THAT(again.err, HasSubstr("ingest: 1 shard, done already"));
}

}  // namespace
}  // namespace voxweld::testing
