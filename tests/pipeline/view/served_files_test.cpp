// What the viewer's server hands out, and what it does not.
#include "pipeline/view/served_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/support/error.h"
#include "tests/pipeline/cli/workplace.h"
#include "tests/support/temp_directory.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

class ServedFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder() / "tiles");
    write_bytes((folder() / "manifest.json").string(), "{}");
    write_bytes((folder() / "tiles/a b.drc").string(), "tile");
    write_bytes((place_.path() / "secret.txt").string(), "secret");
  }
  fs::path folder() const { return place_.path() / "scan.mesh"; }

  const TempDirectory place_;
};

TEST_F(ServedFolder, FindsItsFiles) {
  const ServedFiles files(folder());
  EXPECT_TRUE(files.is_folder());
  EXPECT_EQ(files.name(), "scan.mesh");
  EXPECT_EQ(files.find("manifest.json"), fs::canonical(folder() / "manifest.json"));
  EXPECT_EQ(files.find("tiles/a b.drc"), fs::canonical(folder() / "tiles/a b.drc"));
  EXPECT_EQ(ServedFiles(folder() / "").name(), "scan.mesh") << "with a slash at its end";
}

TEST_F(ServedFolder, LeavesOutWhatIsNoFile) {
  const ServedFiles files(folder());
  for (const char* name : {"", "tiles", "tiles/", "none.drc", "manifest.json/", "manifest.json/x"})
    EXPECT_EQ(files.find(name), std::nullopt) << name;
}

TEST_F(ServedFolder, NeverLeadsUp) {
  const ServedFiles files(folder());
  const std::string secret = (place_.path() / "secret.txt").string();
  ASSERT_TRUE(fs::exists(folder() / "../secret.txt"));
  for (const std::string& name :
       {std::string("../secret.txt"), std::string("tiles/../../secret.txt"), secret, "/" + secret,
        std::string("tiles/../manifest.json"), std::string("./manifest.json"),
        std::string("manifest.json\0x", 15)})
    EXPECT_EQ(files.find(name), std::nullopt) << name;
}

TEST_F(ServedFolder, FollowsLinksWithinAlone) {
  fs::create_symlink("../secret.txt", folder() / "out.txt");
  fs::create_symlink(place_.path(), folder() / "up");
  fs::create_symlink("tiles/a b.drc", folder() / "within.drc");
  fs::create_symlink("nowhere", folder() / "broken");
  const ServedFiles files(folder());
  EXPECT_EQ(files.find("out.txt"), std::nullopt);
  EXPECT_EQ(files.find("up/secret.txt"), std::nullopt);
  EXPECT_EQ(files.find("broken"), std::nullopt);
  EXPECT_EQ(files.find("within.drc"), fs::canonical(folder() / "tiles/a b.drc"));
}

// A folder beside it whose name begins with its own is another one.
TEST_F(ServedFolder, IsNotItsNeighbour) {
  fs::create_directories(place_.path() / "scan.mesh.old");
  write_bytes((place_.path() / "scan.mesh.old/a.drc").string(), "old");
  fs::create_symlink("../scan.mesh.old/a.drc", folder() / "old.drc");
  EXPECT_EQ(ServedFiles(folder()).find("old.drc"), std::nullopt);
}

TEST_F(ServedFolder, OfOneFileItIsAllThereIs) {
  const ServedFiles files(folder() / "tiles/a b.drc");
  EXPECT_FALSE(files.is_folder());
  EXPECT_EQ(files.find("a b.drc"), fs::canonical(folder() / "tiles/a b.drc"));
  for (const char* name : {"", "manifest.json", "../manifest.json", "tiles/a b.drc"})
    EXPECT_EQ(files.find(name), std::nullopt) << name;
}

TEST_F(ServedFolder, HasToBeThere) {
  EXPECT_THROW(ServedFiles(folder() / "none"), InputError);
  EXPECT_THROW(ServedFiles("/dev/null"), InputError);
}

}  // namespace
}  // namespace voxweld::testing
