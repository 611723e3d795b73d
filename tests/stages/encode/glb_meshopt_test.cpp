#include "stages/encode/glb_meshopt.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>

#include "stages/encode/corner_points.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/stages/encode/pair_book.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using testing::book;
using testing::document_of;
using testing::facts_of;
using testing::written;

TileMesh ring(const OutputLattice& lattice = testing::small_lattice()) {
  return testing::make_torus({.around = 60, .across = 30}, lattice);
}

TEST(MeshoptGlb, GivesTheVeryTrianglesBack) {
  for (const bool normals : {false, true})
    for (const TileMesh& mesh : {ring(), book(5, 12), book(300, 3)}) {
      const auto glb = written("meshopt", mesh, facts_of(normals));
      const DecodedMesh read = decode_glb(glb);
      EXPECT_EQ(digest(weld(read, mesh.lattice)),
                digest(weld(corner_points(mesh, normals), mesh.lattice)));
      EXPECT_EQ(read.positions.size(), corner_points(mesh, normals).positions.size());
      EXPECT_EQ(read.normals.empty(), !normals);
      EXPECT_EQ(written("meshopt", mesh, facts_of(normals)), glb);
      EXPECT_LT(glb.size(), written("glb-plain", mesh, facts_of(normals)).size());
    }
}

// A vertex of two tiles decodes to the same floats from both, and from files of other formats. Multiples
// of the step past 2^23 are floats, but none that the filter holds.
TEST(MeshoptGlb, CoordinatesAreThoseOfOtherFormats) {
  const OutputLattice lattices[] = {{1.0 / 64, 14, {-2, -2, -2}},
                                    {1.0 / 4096, 20, {-2, -2, -2}},
                                    {4, 14, {-400, -400, -400}},
                                    {1.0 / 64, 14, {140000, -140000, 0}}};
  for (std::size_t i = 0; i < std::size(lattices); ++i) {
    TileMesh mesh = ring();
    mesh.lattice = lattices[i];
    ASSERT_TRUE(mesh.lattice.fits_floats());
    const auto glb = written("meshopt", mesh, facts_of(false));
    const nlohmann::json view = document_of(glb)["bufferViews"][0];
    EXPECT_EQ(view["extensions"]["EXT_meshopt_compression"].contains("filter"), i < 3) << i;
    auto read = decode_glb(glb).positions, expected = corner_points(mesh, false).positions;
    std::ranges::sort(read);
    std::ranges::sort(expected);
    EXPECT_EQ(read, expected) << i;
  }
}

TEST(MeshoptGlb, NormalsAreWithinThreeTenthsOfADegree) {
  const TileMesh mesh = ring();
  const DecodedMesh read = decode_glb(written("meshopt", mesh, {}));
  const DecodedMesh expected = corner_points(mesh, true);
  // Of each place all normals that it has.
  std::map<std::array<float, 3>, std::vector<std::array<float, 3>>> normals;
  for (std::size_t i = 0; i < expected.positions.size(); ++i)
    normals[expected.positions[i]].push_back(expected.normals[i]);
  double worst = 0;
  for (std::size_t i = 0; i < read.positions.size(); ++i) {
    double best = 10;
    for (const auto& n : normals.at(read.positions[i])) {
      double square = 0;
      for (std::size_t a = 0; a < 3; ++a) square += std::pow(n[a] - read.normals[i][a], 2);
      best = std::min(best, std::sqrt(square));
    }
    worst = std::max(worst, best);
  }
  EXPECT_LT(worst, 0.3 / 57.3);
  EXPECT_GT(worst, 0);
}

TEST(MeshoptGlb, SaysWhatItNeeds) {
  const nlohmann::json doc = document_of(written("meshopt", ring(), {}));
  EXPECT_EQ(doc["extensionsRequired"],
            nlohmann::json::array({"EXT_meshopt_compression", "KHR_mesh_quantization"}));
  EXPECT_EQ(document_of(written("meshopt", ring(), facts_of(false)))["extensionsRequired"],
            nlohmann::json::array({"EXT_meshopt_compression"}));
  ASSERT_EQ(doc["buffers"].size(), 2u);
  EXPECT_EQ(doc["buffers"][1]["extensions"]["EXT_meshopt_compression"]["fallback"], true);
  std::uint64_t end = 0;
  for (const auto& view : doc["bufferViews"]) {
    const auto& how = view["extensions"]["EXT_meshopt_compression"];
    EXPECT_EQ(view["buffer"], 1);
    EXPECT_EQ(how["buffer"], 0);
    EXPECT_EQ(view["byteLength"].get<int>(),
              how["count"].get<int>() * how["byteStride"].get<int>());
    end = view["byteOffset"].get<std::uint64_t>() + view["byteLength"].get<std::uint64_t>();
  }
  EXPECT_GE(doc["buffers"][1]["byteLength"].get<std::uint64_t>(), end);
}

TEST(MeshoptGlb, DamageIsRefusedOrReadAsSomethingElse) {
  const auto glb = written("meshopt", book(4, 6), {});
  for (std::size_t size = 0; size < glb.size(); size += 5)
    EXPECT_THROW(decode_glb(std::span(glb).first(size)), FormatError) << size;
  for (std::size_t at = 0; at < glb.size(); ++at)
    for (const int bit : {0, 3, 5, 7}) {
      auto flipped = glb;
      flipped[at] ^= static_cast<std::byte>(1 << bit);
      try {
        const DecodedMesh read = decode_glb(flipped, "a.glb");
        for (const std::uint32_t pair : read.triangle_pairs) EXPECT_LT(pair, read.pairs.size());
        for (const auto& t : read.triangles)
          for (const std::uint32_t v : t) EXPECT_LT(v, read.positions.size());
      } catch (const FormatError& error) {
        EXPECT_EQ(std::string(error.what()).rfind("a.glb: ", 0), 0u) << error.what();
      }
    }
}

TEST(MeshoptGlb, ViewsThatCannotBeAreRefusedBeforeMemoryIsTaken) {
  const std::vector<std::byte> some(64);
  const auto refuses = [&](std::uint64_t count, std::uint64_t stride, const char* mode,
                           const char* filter, std::uint64_t bytes) {
    nlohmann::ordered_json view = {{"byteLength", bytes}};
    view["extensions"]["EXT_meshopt_compression"] = {
        {"count", count}, {"byteStride", stride}, {"mode", mode}, {"filter", filter}};
    EXPECT_THROW(decode_meshopt_view(view, some, "view"), FormatError)
        << count << " " << stride << " " << mode << " " << filter;
  };
  refuses(1'000'000'000'000, 4, "ATTRIBUTES", "NONE", 4'000'000'000'000);
  refuses(std::uint64_t{1} << 62, 4, "ATTRIBUTES", "NONE", 0);
  refuses(0, 4, "ATTRIBUTES", "NONE", 0);
  refuses(4, 3, "ATTRIBUTES", "NONE", 12);
  refuses(4, 0, "ATTRIBUTES", "NONE", 0);
  refuses(4, 260, "ATTRIBUTES", "NONE", 1040);
  refuses(4, 12, "ATTRIBUTES", "OCTAHEDRAL", 48);
  refuses(4, 8, "ATTRIBUTES", "QUATERNION", 32);
  refuses(4, 4, "TRIANGLES", "NONE", 16);
  refuses(3, 2, "TRIANGLES", "NONE", 6);
  refuses(3, 4, "TRIANGLES", "EXPONENTIAL", 12);
  refuses(3, 4, "INDICES", "NONE", 12);
  refuses(3, 4, "TRIANGLES", "NONE", 16);
  refuses(3, 4, "TRIANGLES", "NONE", 12);  // no header in the bytes
}

// Other programs, where tests/npm_packages.sh has installed them: the decoder of the web, and the Khronos
// validator.
TEST(MeshoptGlb, IsWhatOtherProgramsRead) {
  const std::string decoder = VOXWELD_MESHOPT_CHECK, validator = VOXWELD_GLTF_VALIDATE;
  for (const std::string& script : {decoder, validator})
    if (std::system(fmt::format("node {} > /dev/null 2>&1", script).c_str()) != 0)
      GTEST_SKIP() << "packages of npm are not installed; run tests/npm_packages.sh";
  const testing::TempDirectory directory;
  std::string pairs, files;
  for (const TileMesh& mesh : {ring(), book(5, 12)})
    for (const bool normals : {false, true})
      for (const char* format : {"meshopt", "glb-plain"}) {
        const auto path = directory / fmt::format("{}.glb", pairs.size());
        write_whole_file(path, written(format, mesh, facts_of(normals)), Durability::rename_only);
        pairs += fmt::format(" {}", path.string());
        if (std::string(format) == "meshopt") files += fmt::format(" {}", path.string());
      }
  EXPECT_EQ(std::system(fmt::format("node {}{}", decoder, pairs).c_str()), 0);
  EXPECT_EQ(std::system(fmt::format("node {}{}", validator, files).c_str()), 0);
}

}  // namespace
}  // namespace voxweld
