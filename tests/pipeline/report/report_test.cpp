// The report as the program writes it.
#include <cstdlib>
#include <fstream>
#include <set>

#include "tests/pipeline/cli/workplace.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::size_t times(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::string report_of(const Workplace& place) {
  return read_bytes(place.at("scene.mesh/report.html"));
}

// Each tag that is opened is closed in its turn, but for those that have no end.
void expect_balanced(const std::string& html) {
  const std::set<std::string> single = {"!DOCTYPE", "meta", "img"};
  std::vector<std::string> open;
  for (auto at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
    const auto end = html.find('>', at);
    ASSERT_NE(end, std::string::npos);
    const bool closes = html[at + 1] == '/';
    const auto begin = at + (closes ? 2 : 1);
    const std::string name = html.substr(begin, html.find_first_of(" >/\n", begin) - begin);
    if (closes) {
      ASSERT_FALSE(open.empty()) << name;
      ASSERT_EQ(open.back(), name) << html.substr(at, 80);
      open.pop_back();
    } else if (!single.contains(name) && html[end - 1] != '/') {
      open.push_back(name);
    }
  }
  EXPECT_TRUE(open.empty());
}

void expect_self_contained(const std::string& html) {
  for (const char* outside : {"http:", "https:", "<script", "<link", "url(", "@import", "<iframe"})
    EXPECT_THAT(html, Not(HasSubstr(outside)));
  EXPECT_EQ(times(html, "src=\""), times(html, "src=\"data:image/png;base64,"));
  EXPECT_EQ(times(html, "href=\""), times(html, "href=\"data:image/png;base64,"));
}

TEST(Report, OfARunHasAllSections) {
  const Workplace place;
  place.run_scene({"surface.isovalue=127.5", "simplify.tolerance=0.2"});
  const std::string html = report_of(place);
  for (const char* section :
       {"The mesh", "What was made", "Slices", "Histogram", "Stages", "Cells and errors", "Config"})
    EXPECT_THAT(html, HasSubstr(std::string("<h2>") + section + "</h2>"));
  EXPECT_EQ(times(html, "<img "), 3u);
  EXPECT_EQ(times(html, "<image "), 3u);
  EXPECT_EQ(times(html, "class=\"iso\""), 4u);  // three contours and the mark in the histogram
  EXPECT_THAT(html, HasSubstr("isovalue 127.5"));
  EXPECT_THAT(html, HasSubstr("<code>simplify.tolerance</code></th><td><code>0.2</code>"));
  EXPECT_THAT(html, Not(HasSubstr("<code>simplify.refine</code>")));  // as by default
  const auto counts = place.info(place.at("scene.mesh")).at("counts");
  EXPECT_THAT(html, HasSubstr("<h1>scene.mesh</h1>"));
  EXPECT_THAT(html, HasSubstr("Made by voxweld "));
  EXPECT_GT(counts.at("triangles"), 1000);
  EXPECT_LT(html.size(), 3'000'000u);
  expect_balanced(html);
  expect_self_contained(html);
}

TEST(Report, IsTheSameTwiceAndElsewhere) {
  const Workplace place;
  place.run_scene({});
  place.run({"report", place.at("scene.mesh"), "-o", place.at("a.html")});
  const std::string html = report_of(place);
  EXPECT_TRUE(html == read_bytes(place.at("a.html")));
  fs::remove(place.at("scene.mesh/report.html"));
  EXPECT_THAT(place.run({"report", place.at("scene.mesh/")}).out, HasSubstr("report.html: "));
  EXPECT_TRUE(html == report_of(place));
}

TEST(Report, SaysWhereTheVolumeIsGoneOrChanged) {
  const Workplace place;
  place.run_scene({});
  const auto after = [&](const std::string& words) {
    place.run({"report", place.at("scene.mesh")});
    const std::string html = report_of(place);
    EXPECT_THAT(html, HasSubstr(words));
    EXPECT_THAT(html, HasSubstr("So there are no slices and no histogram."));
    EXPECT_THAT(html, Not(HasSubstr("<h2>Slices")));
    EXPECT_EQ(times(html, "<img "), 3u);  // the mesh is there
    expect_balanced(html);
  };
  write_bytes(place.at("scene.nrrd"), "no volume");
  after("The volume has changed since the mesh was made of it");
  fs::remove(place.at("scene.nrrd"));
  after("The volume is gone: there is no ");
}

TEST(Report, IsNotWrittenWhereThatIsAskedFor) {
  const Workplace place;
  place.run_scene({"output.report=false"});
  EXPECT_FALSE(fs::exists(place.at("scene.mesh/report.html")));
  const auto meshes = [&] {
    return std::vector<std::string>{read_bytes(place.at("scene.mesh/mesh.drc")),
                                    read_bytes(place.at("scene.mesh/mesh.glb")),
                                    read_bytes(place.at("scene.mesh/tiles.jsonl"))};
  };
  const auto before = meshes();
  place.run({"run", place.at("scene.toml")});
  EXPECT_TRUE(fs::exists(place.at("scene.mesh/report.html")));
  EXPECT_TRUE(before == meshes());
}

TEST(Report, IsOnlyWrittenAgainWhereSomethingChanged) {
  const Workplace place;
  place.run_scene({});
  const std::string file = place.at("scene.mesh/report.html");
  const std::string first = report_of(place);
  const auto mark = fs::file_time_type(std::chrono::seconds(12345));
  fs::last_write_time(file, mark);
  place.run({"run", place.at("scene.toml")});
  EXPECT_EQ(fs::last_write_time(file), mark);
  place.run({"run", place.at("scene.toml"), "--set", "simplify.tolerance=0.4"});
  EXPECT_FALSE(first == report_of(place));
  EXPECT_THAT(report_of(place), HasSubstr("<code>simplify.tolerance</code></th><td><code>0.4"));
  // It is of the meshes: with others and no report of these it goes.
  place.run({"run", place.at("scene.toml"), "--set", "simplify.tolerance=0.3", "--set",
             "output.report=false"});
  EXPECT_FALSE(fs::exists(file));
  EXPECT_EQ(place.run({"verify", place.at("scene.mesh")}).exit_code, 0);
}

TEST(Report, IsMadeByTheRunAsAWholeOnly) {
  const Workplace place;
  place.run_scene({});
  fs::remove(place.at("scene.mesh/report.html"));
  place.run({"encode", place.at("scene.toml")});
  EXPECT_FALSE(fs::exists(place.at("scene.mesh/report.html")));
}

TEST(Report, LeavesAPageThatIsNotItsOwn) {
  const Workplace place;
  const std::string file = place.at("scene.mesh/report.html");
  fs::create_directories(place.at("scene.mesh"));
  write_bytes(file, "mine");
  place.run({"init", place.phantom("scene.nrrd"), "-o", place.at("scene.toml")});
  const ProgramResult result = place.run({"run", place.at("scene.toml")});
  EXPECT_THAT(result.err, AllOf(HasSubstr("warning: no report is written: "), HasSubstr(file),
                                HasSubstr("output.report = false")));
  place.run({"run", place.at("scene.toml"), "--set", "simplify.tolerance=0.4"});
  EXPECT_EQ(read_bytes(file), "mine");
  expect_refused({"report", place.at("scene.mesh")}, {file, "exists already", "--force"});
  place.run({"report", place.at("scene.mesh"), "--force"});
  EXPECT_THAT(report_of(place), HasSubstr("<h1>scene.mesh</h1>"));
}

TEST(Report, ThatCannotBeWrittenFailsNoRun) {
  const Workplace place;
  fs::create_directories(place.at("scene.mesh/report.html/in the way"));
  place.run({"init", place.phantom("scene.nrrd"), "-o", place.at("scene.toml")});
  EXPECT_THAT(place.run({"run", place.at("scene.toml")}).err, HasSubstr("no report is written"));
  EXPECT_TRUE(fs::exists(place.at("scene.mesh/manifest.json")));
}

TEST(Report, RefusesWhatIsNoOutput) {
  const Workplace place;
  expect_refused({"report", place.at("nothing")}, {"no such folder", "output.directory"});
  place.run_scene({"output.report=false"});
  expect_refused({"report", place.at("scene.mesh"), "-o", place.at("a.pdf")}, {"a.pdf", ".html"});
  nlohmann::json manifest = nlohmann::json::parse(read_bytes(place.at("scene.mesh/manifest.json")));
  manifest["config"].erase("toml");
  write_bytes(place.at("scene.mesh/manifest.json"), manifest.dump());
  expect_refused({"report", place.at("scene.mesh")}, {"manifest.json", "has no config"});
}

TEST(Report, OfLabelsHasTheirNamesAndColours) {
  const Workplace place;
  place.run(
      {"phantom", "junctions", "--size", "24", "--type", "uint16", "-o", place.at("scene.nrrd")});
  place.run({"init", place.at("scene.nrrd"), "--labels", "-o", place.at("scene.toml")});
  write_bytes(place.at("map.csv"), "label,name,color\n1,\"<b>&co\",#ff8000\n2,two,#0080ff\n");
  for (const char* mode : {"each", "shared"}) {
    place.run({"run", place.at("scene.toml"), "--set", std::string("labels.mode=") + mode, "--set",
               "labels.map=" + place.at("map.csv")});
    const std::string html = report_of(place);
    EXPECT_THAT(html, HasSubstr("<h2>Largest labels</h2>"));
    EXPECT_THAT(html, HasSubstr("background:#ff8000\"></span>1 &lt;b&gt;&amp;co</th>"));
    EXPECT_THAT(html, HasSubstr("background:#0080ff\"></span>2 two</th>"));
    EXPECT_THAT(html, HasSubstr("in the colours of the labels"));
    EXPECT_THAT(html, Not(HasSubstr("<h2>Histogram")));
    EXPECT_EQ(times(html, "class=\"iso\""), 0u);
    expect_balanced(html);
    expect_self_contained(html);
  }
}

// The copy in the work directory has the name of the rule, the manifest the number it chose.
TEST(Report, FindsTheCopyThatAFilterLeft) {
  const Workplace place;
  place.run({"init", place.phantom("scene.nrrd"), "-o", place.at("scene.toml")});
  std::ofstream(place.at("scene.toml"), std::ios::app)
      << "[[filter]]\ntype = \"gaussian\"\nsigma = 1.0\n"
      << "[[filter]]\ntype = \"keep\"\nmin_voxels = 3\n";
  place.run({"run", place.at("scene.toml"), "--set", "surface.isovalue=otsu"});
  EXPECT_THAT(report_of(place), HasSubstr("<h2>Slices"));
  fs::remove_all(place.at("scene.work"));
  place.run({"report", place.at("scene.mesh")});
  EXPECT_THAT(report_of(place),
              AllOf(HasSubstr("the filtered copy of it in "), Not(HasSubstr("<h2>Slices"))));
}

// Its samples come from the copy that was made of them, or, where that is gone, from the stream.
TEST(Report, ReadsAStreamOnceMoreWhereItsCopyIsGone) {
  const Workplace place;
  place.run({"phantom", "gyroid", "--size", "24", "--type", "uint8", "-o", place.at("scene.raw")});
  ASSERT_EQ(std::system(("gzip -f " + place.at("scene.raw")).c_str()), 0);
  write_bytes(place.at("scene.nhdr"),
              "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 24 24 24\nencoding: gzip\n"
              "data file: scene.raw.gz\n");
  place.run({"init", place.at("scene.nhdr"), "-o", place.at("scene.toml")});
  place.run({"run", place.at("scene.toml")});
  const std::string html = report_of(place);
  EXPECT_THAT(html, HasSubstr("<h2>Slices"));
  fs::remove_all(place.at("scene.work"));
  place.run({"report", place.at("scene.mesh")});
  EXPECT_TRUE(html == report_of(place));  // so small that all samples are taken either way
}

TEST(Report, OfAMeshAsInputHasNoSlices) {
  const Workplace place;
  place.run_scene({"output.report=false"});
  place.run({"export", place.at("scene.mesh"), "--weld", "-o", place.at("in.ply")});
  place.run(
      {"init", place.at("in.ply"), "--resolution", "24", "-o", place.at("scene.toml"), "--force"});
  place.run({"run", place.at("scene.toml"), "--force"});
  EXPECT_THAT(report_of(place), HasSubstr("The input is a mesh and not a volume."));
  EXPECT_EQ(times(report_of(place), "<img "), 3u);
}

}  // namespace
}  // namespace voxweld::testing
