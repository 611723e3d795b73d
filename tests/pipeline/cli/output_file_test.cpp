// A command writes over nothing unless it is told to, and never over what it reads.
#include <fstream>

#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

// A file that is there already, and what a command says that would write over it.
void expect_kept(const std::string& path, const std::vector<std::string>& arguments,
                 const std::vector<std::string>& message) {
  const std::string before = read_bytes(path);
  expect_refused(arguments, message);
  EXPECT_EQ(read_bytes(path), before) << path;
}

TEST(OutputFile, IsNotWrittenOverWithoutForce) {
  const Workplace place;
  place.run_scene({"output.formats=[\"drc\"]"});
  const std::string mesh = place.at("scene.mesh");
  const std::vector<std::vector<std::string>> commands = {
      {"render", mesh, "--width", "40", "--height", "30", "-o", place.at("a.png")},
      {"export", mesh + "/mesh.drc", "-o", place.at("a.ply")},
      {"phantom", "sphere", "--size", "16", "-o", place.at("a.nrrd")},
      {"init", place.at("scene.nrrd"), "-o", place.at("a.toml")}};
  for (const std::vector<std::string>& command : commands) {
    const std::string& file = command.back();
    place.run(command);
    const std::string made = read_bytes(file);
    expect_kept(file, command, {file + ": exists already; use --force to write over it"});
    write_bytes(file, "old");
    std::vector<std::string> forced = command;
    forced.emplace_back("--force");
    place.run(forced);
    EXPECT_EQ(read_bytes(file), made) << file;
    fs::remove(file);
    fs::create_directory(file);
    forced.back() = "--force";
    expect_refused(forced, {file + ": is a directory; name the file to write"});
    fs::remove(file);
  }
}

TEST(OutputFile, IsNeverTheInputOfInit) {
  const Workplace place;
  const std::string keep = place.phantom("keep.nrrd");
  fs::create_symlink(keep, place.at("soft.toml"));
  fs::create_hard_link(keep, place.at("hard.toml"));
  for (const std::string& name : {keep, place.at("soft.toml"), place.at("hard.toml")})
    for (const char* force : {"--force", "--full"})
      expect_kept(keep, {"init", keep, "-o", name, force},
                  {name + ": is the input itself", "-o for another name"});
  // The samples lie beside their header.
  place.phantom("two.nhdr");
  expect_kept(place.at("two.raw"),
              {"init", place.at("two.nhdr"), "-o", place.at("two.raw"), "--force"},
              {"two.raw: is the input itself"});
  place.phantom("three.zarr");
  const std::string part = first_file(place.at("three.zarr"), "zarr.json");
  expect_kept(part, {"init", place.at("three.zarr"), "-o", part, "--force"},
              {"zarr.json: is the input itself"});
}

TEST(OutputFile, IsNeverAMeshThatIsRead) {
  const Workplace place;
  place.run_scene({"output.formats=[\"drc\"]"});
  const std::string mesh = place.at("scene.mesh/mesh.drc");
  fs::create_symlink(mesh, place.at("a.ply"));
  expect_kept(mesh, {"export", mesh, "-o", place.at("a.ply"), "--force"}, {"is the input itself"});
  const std::string tile = first_file(place.at("scene.mesh/tiles"), ".drc");
  fs::create_hard_link(tile, place.at("a.png"));
  expect_kept(tile, {"render", place.at("scene.mesh"), "-o", place.at("a.png"), "--force"},
              {"a.png: is the input itself (" + tile + ")"});
}

TEST(OutputFile, OfAPhantomMayBeTwoOrAFolder) {
  const Workplace place;
  write_bytes(place.at("a.raw"), "mine");
  expect_kept(place.at("a.raw"), {"phantom", "sphere", "--size", "16", "-o", place.at("a.nhdr")},
              {"a.raw: exists already"});
  EXPECT_FALSE(fs::exists(place.at("a.nhdr")));
  const std::vector<std::string> zarr = {"phantom", "sphere", "--size",
                                         "16",      "-o",     place.at("a.zarr")};
  place.run(zarr);
  expect_refused(zarr, {"a.zarr: exists already"});
  place.run(zarr + std::vector<std::string>{"--force"});
  fs::create_directory(place.at("mine.zarr"));
  expect_refused({"phantom", "sphere", "-o", place.at("mine.zarr"), "--force"},
                 {"mine.zarr: is a directory"});
}

TEST(OutputFile, IsNoDevice) {
  const Workplace place;
  const std::string volume = place.phantom("scene.nrrd");
  expect_refused({"init", volume, "-o", "/dev/null", "--force"}, {"/dev/null: is a device"});
  EXPECT_FALSE(fs::is_regular_file("/dev/null"));
}

TEST(OutputFile, OfRenderIsAPng) {
  const Workplace place;
  expect_refused({"render", place.at("no.mesh"), "-o", place.at("b.jpg")},
                 {"b.jpg: a picture is written as .png; give it such a name"});
  EXPECT_FALSE(fs::exists(place.at("b.jpg")));
}

}  // namespace
}  // namespace voxweld::testing
