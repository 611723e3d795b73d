// What `init` says where the user may know better.
#include <cmath>
#include <functional>

#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string said(const Workplace& place, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "init");
  arguments.insert(arguments.end(), {"-o", place.at("a.toml"), "--force"});
  return place.run(arguments).err;
}

TEST(InitHints, IntegersThatLookLikeLabels) {
  const Workplace place;
  const std::string cells = place.at("cells.nrrd");
  place.run({"phantom", "labels", "--size", "48", "--type", "uint16", "-o", cells});
  EXPECT_THAT(said(place, {cells}), HasSubstr("hint: " + cells + ": the samples look like labels"));
  EXPECT_THAT(said(place, {cells, "--labels"}), Not(HasSubstr("hint")));
  for (const char* kind : {"gyroid", "noise", "part"}) {
    place.run({"phantom", kind, "--size", "32", "--type", "uint8", "--force", "-o",
               place.at("scan.nrrd")});
    EXPECT_THAT(said(place, {place.at("scan.nrrd")}), Not(HasSubstr("look like labels"))) << kind;
  }
}

TEST(InitHints, PhantomsWhoseIsovalueIsKnown) {
  const Workplace place;
  const std::string input = place.phantom("ball.nrrd");
  EXPECT_THAT(said(place, {input}),
              HasSubstr("hint: " + input +
                        ": a phantom whose true surface is at surface.isovalue = "
                        "127.5, surface.inside = \"below\""));
}

// Floats, row by row: 16^3 of f(distance from the middle).
std::string field_file(const Workplace& place, const std::function<float(double)>& f) {
  constexpr int n = 16;
  std::vector<float> samples;
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) samples.push_back(f(std::hypot(x - 7.5, y - 7.5, z - 7.5)));
  std::string path = place.at("field.nrrd");
  write_bytes(path,
              "NRRD0004\ntype: float\ndimension: 3\nsizes: 16 16 16\nencoding: raw\n"
              "endian: little\n\n" +
                  std::string(reinterpret_cast<const char*>(samples.data()),
                              samples.size() * sizeof(float)));
  return path;
}

TEST(InitHints, FieldsWhoseSurfaceMayBeAtZero) {
  const Workplace place;
  const auto hint = [&](const std::function<float(double)>& f) {
    return said(place, {field_file(place, f)});
  };
  const auto offer = HasSubstr("set surface.isovalue = 0, and surface.inside = \"below\"");
  // Distances from a ball, negative inside.
  EXPECT_THAT(hint([](double r) { return static_cast<float>(r - 7); }), offer);
  EXPECT_THAT(hint([](double r) { return static_cast<float>(r - 7); }),
              HasSubstr("% of the samples are below 0"));
  // None on one side; two clear classes; hardly any below 0, as a filter leaves them.
  EXPECT_THAT(hint([](double r) { return static_cast<float>(r); }), Not(HasSubstr("hint")));
  EXPECT_THAT(hint([](double r) { return r < 5 ? -1000 + static_cast<float>(r) : 40; }),
              Not(HasSubstr("hint")));
  EXPECT_THAT(hint([](double r) { return static_cast<float>(r < 5 ? -0.01 : r); }),
              Not(HasSubstr("hint")));
}

TEST(InitHints, MeshesAndRawFilesWithoutUnitOrSpacing) {
  const Workplace place;
  const std::string mesh = place.at("part.off");
  write_bytes(mesh, "OFF\n4 4 0\n0 0 0\n4 0 0\n0 4 0\n0 0 4\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  EXPECT_THAT(said(place, {mesh, "--resolution", "16"}),
              HasSubstr("hint: " + mesh + ": a mesh says no unit"));
  EXPECT_THAT(said(place, {mesh, "--resolution", "16", "--unit", "mm"}), Not(HasSubstr("hint")));
  std::string bytes;
  for (int i = 0; i < 512; ++i) bytes += static_cast<char>(i % 100);
  write_bytes(place.at("scan.raw"), bytes);
  const std::vector<std::string> raw = {
      place.at("scan.raw"), "--size", "8", "8", "8", "--type", "uint8"};
  const auto with = [&](std::vector<std::string> more) {
    std::vector<std::string> all = raw;
    all.insert(all.end(), more.begin(), more.end());
    return said(place, all);
  };
  EXPECT_THAT(with({}), HasSubstr("scan.raw: says no spacing"));
  EXPECT_THAT(with({"--spacing", "0.5"}), HasSubstr("scan.raw: says no unit"));
  EXPECT_THAT(with({"--spacing", "0.5", "--unit", "mm"}), Not(HasSubstr("hint")));
}

}  // namespace
}  // namespace voxweld::testing
