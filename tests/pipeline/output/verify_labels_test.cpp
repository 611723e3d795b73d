// verify of an output with a mesh for each label.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/output/verify.h"
#include "storage/support/error.h"
#include "tests/pipeline/output/output_directory.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using testing::expect_problem;
using ::testing::HasSubstr;
using testing::of_tile;
using testing::OutputDirectory;
using testing::verified;
using testing::without_last_triangle;

// A torus in tiles of 8^3 cells and two cubes that share a face; each is closed by itself.
OutputDirectory labels_output() {
  const auto lattice = testing::small_lattice();
  OutputDirectory out;
  out.merged = false;
  out.tiles =
      testing::cut_into_tiles(testing::make_torus({.around = 48, .across = 24}, lattice), 3);
  out.labels.assign(out.tiles.size(), 3);
  for (const double x : {4.0, 8.0}) {
    out.tiles.push_back(testing::make_cube(lattice, {x, 4, 4}, 4, 2));
    out.tiles.back().tile = {6, {}};
    out.labels.push_back(x < 5 ? 5 : std::uint64_t{1} << 40);
  }
  return out;
}

TEST(VerifyLabels, EachIsClosedByItself) {
  const OutputDirectory output = labels_output();
  const VerifyReport report = verified(output);
  EXPECT_TRUE(report.good()) << to_text(report);
  EXPECT_EQ(report.labels, 3u);
  EXPECT_EQ(report.tiles, output.tiles.size());
  EXPECT_EQ(report.vertices, 48u * 24 + 2 * 26);
  EXPECT_GT(report.seam_vertices, 100u);
  EXPECT_THAT(to_text(report), HasSubstr("3 labels, "));
  EXPECT_THAT(to_json_text(report), HasSubstr("\"labels\":3"));
  // As one surface the cubes' vertices would be welded.
  OutputDirectory one = output;
  one.labels.clear();
  expect_problem(one, "counts.vertices is 1195, the tiles have 1204");
}

TEST(VerifyLabels, ACrackIsNamedWithItsLabel) {
  OutputDirectory output = labels_output();
  output.damage = of_tile(5, without_last_triangle);
  expect_problem(output, "label 3 tile");
  expect_problem(output, "a crack");
  output.damage = of_tile(output.tiles.size() - 1, without_last_triangle);
  expect_problem(output, "label 1099511627776 tile 6/0,0,0");
}

// A tile that another label has, too, does not make up for one that is missing.
TEST(VerifyLabels, TilesOfOtherLabelsAreNotWelded) {
  OutputDirectory output = labels_output();
  output.labels[4] = 5;
  std::rotate(output.tiles.begin() + 4, output.tiles.begin() + 5, output.tiles.end() - 2);
  output.labels.erase(output.labels.begin() + 4);
  output.labels.insert(output.labels.end() - 2, 5);
  expect_problem(output, "label 3 tile");
  expect_problem(output, "label 5 tile");
}

TEST(VerifyLabels, WhatIsListedOfALabelIsCompared) {
  OutputDirectory output = labels_output();
  const auto expect_of = [&](const std::function<void(LabelRecord&)>& relabel,
                             const std::string& what) {
    output.relabel = [&](LabelRecord& record) {
      if (record.label == 5) relabel(record);
    };
    expect_problem(output, "labels.jsonl label 5: " + what);
  };
  expect_of([](LabelRecord& r) { ++r.vertices; }, "has 26 vertices, 27 are listed");
  expect_of([](LabelRecord& r) { ++r.triangles; }, "has 48 triangles, 49 are listed");
  expect_of([](LabelRecord& r) { r.tiles = 2; }, "has 1 tiles, 2 are listed");
  expect_of([](LabelRecord& r) { *r.volume += 0.001; },
            "encloses a volume of 64, 64.001 is listed");
  expect_of([](LabelRecord& r) { r.volume.reset(); }, "encloses a volume of 64, none is listed");
  expect_of([](LabelRecord& r) { r.area *= 1.001; }, "has an area of 96");
  expect_of([](LabelRecord& r) { r.bounds->hi.z = 9; }, "does not lie where its bounds say");
  expect_of([](LabelRecord& r) { r.files.pop_back(); }, "its files are not those of its tiles");
  output.relabel = [](LabelRecord& r) {
    if (r.label == 5) r.label = 4;
  };
  expect_problem(output, "lists label 4 where the tiles have label 5");
  output.relabel = nullptr;
  output.restate = [](Manifest& m) { ++m.counts.labels; };
  expect_problem(output, "counts.labels");
}

TEST(VerifyLabels, LabelsAscendAndAreAllListed) {
  OutputDirectory output = labels_output();
  std::swap(output.tiles[output.tiles.size() - 1], output.tiles[output.tiles.size() - 2]);
  std::swap(output.labels[output.labels.size() - 1], output.labels[output.labels.size() - 2]);
  expect_problem(output, "labels must ascend");
  output = labels_output();
  output.relist = of_tile(2, [](TileRecord& record) { record.label.reset(); });
  expect_problem(output, "is of no label");
  output = labels_output();
  const testing::TempDirectory directory;
  output.write(directory.path());
  std::filesystem::remove(directory / labels_name);
  EXPECT_THROW(verify_output(directory.path()), StorageError);
}

TEST(VerifyLabels, WrongHashOfTheListIsNamed) {
  OutputDirectory output = labels_output();
  output.restate = [](Manifest& m) { m.files.at(0).xxh3_128[0] = 'x'; };
  expect_problem(output, "labels.jsonl: damaged: its hash is");
}

TEST(LabelList, ReadsBackWhatWasWritten) {
  LabelRecord full;
  full.label = std::uint64_t{1} << 63;
  full.name = "Gyrus \"a\" \xc3\xa9";
  full.color = {1, 2, 255};
  full.vertices = 5;
  full.triangles = 6;
  full.volume = 1.0 / 3;
  full.area = 1e-9;
  full.bounds = {{-0.5, 1, 2}, {3, 4, 5.25}};
  full.tiles = 2;
  full.files = {"labels/x01/200.drc", "labels/x01/200.glb"};
  LabelRecord bare;
  bare.label = 7;
  for (const LabelRecord& record : {full, bare})
    EXPECT_EQ(parse_label_record(to_json_line(record), "here"), record);
  for (const char* line : {"{}", "{\"label\":-1}", "[]", "{\"label\":1,\"vertices\":true}"})
    EXPECT_THROW(parse_label_record(line, "here"), FormatError) << line;
  full.files = {"../elsewhere"};
  EXPECT_THROW(parse_label_record(to_json_line(full), "here"), FormatError);
}

}  // namespace
}  // namespace voxweld
