// A level set of OpenVDB's from the file to the mesh.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "tests/pipeline/run/scene.h"
#include "tests/support/python_script.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr double radius = 6.0, voxel = 0.25;

class Vdb : public ::testing::Test {
 protected:
  void SetUp() override {
    VOXWELD_NEEDS_PYTHON("pyopenvdb");
    run_script(*python_with("pyopenvdb"), VOXWELD_WRITE_SPHERE_VDB,
               {ball().string(), std::to_string(radius), std::to_string(voxel)});
  }
  fs::path ball() const { return directory_ / "ball.vdb"; }
  fs::path done(const Arguments& arguments) {
    const ProgramResult result = run_voxweld(arguments);
    VOXWELD_EXPECT_DONE(result);
    said_ = result.out;
    return directory_ / "ball.mesh";
  }

  TempDirectory directory_;
  std::string said_;
};

// Six times the volume that the triangles enclose.
double six_volumes(const DecodedMesh& mesh) {
  double sum = 0;
  const auto at = [&](std::uint32_t v) {
    const auto& p = mesh.positions[v];
    return Vec3{p[0], p[1], p[2]};
  };
  for (const auto& t : mesh.triangles) sum += dot(at(t[0]), cross(at(t[1]), at(t[2])));
  return sum;
}

void expect_ball(const fs::path& output) {
  const VerifyReport report = verify_output(output);
  EXPECT_TRUE(report.good()) << to_text(report);
  const DecodedMesh mesh = load_mesh(output / "mesh.drc");
  const nlohmann::json frame =
      nlohmann::json::parse(std::ifstream(output / "manifest.json")).at("frame");
  const Vec3 origin{frame.at("origin")[0], frame.at("origin")[1], frame.at("origin")[2]};
  const Vec3 center = Vec3{10, -4, 7.5} - origin;
  for (const auto& p : mesh.positions) {
    const Vec3 d = Vec3{p[0], p[1], p[2]} - center;
    EXPECT_NEAR(std::sqrt(dot(d, d)), radius, voxel / 5);
  }
  const double whole = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  EXPECT_NEAR(six_volumes(mesh) / 6, whole, whole / 100);
}

TEST_F(Vdb, ALevelSetBecomesTheBallThatItIsOf) {
  const fs::path config = directory_ / "ball.toml";
  std::ofstream(config)
      << "[input]\npath = \"ball.vdb\"\n[surface]\nisovalue = 0\ninside = \"below\"\n";
  expect_ball(done({"run", config.string()}));
}

TEST_F(Vdb, InitAndInfoKnowTheSurface) {
  const fs::path config = directory_ / "ball.toml";
  done({"init", ball().string(), "-o", config.string()});
  EXPECT_THAT(said_, HasSubstr("surface.isovalue = 0, surface.inside = \"below\""));
  expect_ball(done({"run", config.string()}));
  done({"info", ball().string(), "--json"});
  const nlohmann::json info = nlohmann::json::parse(said_);
  EXPECT_EQ(info.at("surface"), nlohmann::json({{"isovalue", 0.0}, {"inside", "below"}}));
  EXPECT_EQ(info.at("choices").size(), 2U);
}

// In bricks, copied first, and on few threads: the same mesh.
TEST_F(Vdb, TheMeshIsTheSameHoweverItIsRead) {
  const fs::path config = directory_ / "ball.toml";
  std::ofstream(config)
      << "[input]\npath = \"ball.vdb\"\n[surface]\nisovalue = 0\ninside = \"below\"\n";
  const Tree in_place = output_tree(done({"run", config.string()}));
  fs::remove_all(directory_ / "ball.mesh");
  fs::remove_all(directory_ / "ball.work");
  const Tree copied = output_tree(
      done({"run", config.string(), "--set", "work.copy=true", "--set", "run.threads=1"}));
  EXPECT_TRUE(in_place.contains("mesh.drc"));
  EXPECT_EQ(difference(in_place, copied), "");
}

TEST_F(Vdb, ABoxTooLargeForARunIsToldInFigures) {
  const fs::path far = directory_ / "far.vdb";
  const std::string script =
      "import pyopenvdb as v; g = v.FloatGrid(); g.name = \"far\"; "
      "g.fill((0, 0, 0), (600000, 0, 0), 1.0); v.write(\"" +
      far.string() + "\", grids=[g])";
  ASSERT_EQ(std::system((*python_with("pyopenvdb") + " -c " + quoted(script)).c_str()), 0);
  const fs::path config = directory_ / "far.toml";
  std::ofstream(config) << "[input]\npath = \"far.vdb\"\n[surface]\nisovalue = 0.5\n";
  const ProgramResult result = run_voxweld({"run", config.string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("over 600004 needs"));
}

}  // namespace
}  // namespace voxweld::testing
