#include <fmt/format.h>

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string legacy_type(SampleType type) {
  constexpr const char* names[] = {"unsigned_char", "char",  "unsigned_short", "short",
                                   "unsigned_int",  "int",   "unsigned_long",  "long",
                                   "float",         "double"};
  return names[static_cast<std::size_t>(type)];
}

std::string legacy_start(const std::string& form, Index3 size) {
  return fmt::format(
      "# vtk DataFile Version 3.0\na title\n{}\nDATASET STRUCTURED_POINTS\nDIMENSIONS {} {} {}\n"
      "SPACING 1 2 0.5\nORIGIN 1 2 3\n",
      form, size.x, size.y, size.z);
}

Bytes values_of(const KnownVolume& volume, bool text) {
  return text ? to_bytes(as_text(volume)) : volume.stored(std::endian::big);
}

Bytes legacy_file(const KnownVolume& volume, bool text) {
  return to_bytes(legacy_start(text ? "ASCII" : "BINARY", volume.size) +
                  fmt::format("POINT_DATA {}\nSCALARS v {} 1\nLOOKUP_TABLE default\n",
                              volume.size.x * volume.size.y * volume.size.z,
                              legacy_type(volume.type))) +
         values_of(volume, text) + to_bytes("\n");
}

TEST(VtkLegacy, EveryTypeTextAndBinary) {
  const VolumeFolder directory;
  for (const SampleType type : all_types)
    for (const bool text : {false, true}) {
      const KnownVolume volume = make_volume(type, {6, 5, 7});
      const auto source = directory.open("a.vtk", legacy_file(volume, text));
      expect_volume(*source, volume);
      const VolumeInfo& info = source->info();
      EXPECT_EQ(info.format, "vtk");
      EXPECT_EQ(info.access, text ? Access::stream : Access::box);
      EXPECT_EQ(info.geometry.spacing, (Vec3{1, 2, 0.5}));
      EXPECT_EQ(info.geometry.origin, (Vec3{1, 2, 3}));
      EXPECT_EQ(info.warnings.size(), 0U);
      EXPECT_EQ(info.choices.size(), 0U);
    }
}

// All that may stand between: each is passed, in text and binary, and each array can be chosen.
TEST(VtkLegacy, ArraysAmongOthers) {
  const VolumeFolder directory;
  const Index3 size{3, 4, 5};
  const KnownVolume first = make_volume(SampleType::u16, size, 1),
                    second = make_volume(SampleType::f32, size, 2),
                    cells = make_volume(SampleType::i16, {2, 3, 4}, 3),
                    pairs = make_volume(SampleType::u8, {4, 2, 1}, 5),
                    colours = make_volume(SampleType::u8, {4, 1, 3}, 6);
  for (const bool text : {false, true}) {
    const auto part = [&](const std::string& line, const KnownVolume& volume) {
      return to_bytes(line + "\n") + values_of(volume, text) + to_bytes("\n");
    };
    const Bytes vectors =
        part("VECTORS grad%20ient double", make_volume(SampleType::f64, {9, 4, 5}));
    const Bytes whole =
        to_bytes(legacy_start(text ? "ASCII" : "BINARY", size)) +
        part("FIELD FieldData 1\nTimeValue 4 2 unsigned_char", pairs) +
        to_bytes("METADATA\nINFORMATION 1\nNAME a LOCATION b\nDATA 2 0 1\n\nCELL_DATA 24\n") +
        part("FIELD FieldData 1\nin 1 24 short", cells) + to_bytes("POINT_DATA 60\n") + vectors +
        part("SCALARS one unsigned_short\nLOOKUP_TABLE mine", first) +
        part("LOOKUP_TABLE mine 3", colours) +
        part("FIELD FieldData 2\ntwo%2b 1 60 float", second) +
        part("METADATA\nCOMPONENT_NAMES\nx\n\nother 2 4 unsigned_char", pairs);
    const std::string path = write_file(directory / "a.vtk", whole).string();
    const auto open = [&](const std::string& dataset) {
      return open_volume({.path = path, .select = {.dataset = dataset}});
    };
    expect_volume(*open("one"), first);
    expect_volume(*open("two+"), second);
    expect_volume(*open(""), first);  // the scalars
    const auto in = open("cells/in");
    expect_volume(*in, cells);
    EXPECT_EQ(in->info().geometry.origin, (Vec3{1.5, 3, 3.25}));
    EXPECT_THAT(in->info().warnings, ElementsAre(HasSubstr("middle of cells")));
    ASSERT_EQ(in->info().choices.size(), 4U);
    EXPECT_EQ(in->info().choices[1].value, "grad ient");
    expect_says(complaint({.path = path, .select = {.dataset = "grad ient"}}),
                {"3 values a sample", "choose another"});
    expect_says(complaint({.path = path, .select = {.dataset = "x"}}), {"'one' (unsigned_short)"});
    // Cut short: an error, or what is whole still.
    for (std::size_t length = 160; length < whole.size(); length += 11)
      directory.complaint("b.vtk", std::span(whole).first(length));
  }
}

// VTK writes bytes so that are scalars.
TEST(VtkLegacy, ColourScalarsOfOneValue) {
  const VolumeFolder directory;
  const KnownVolume bytes = make_volume(SampleType::u8, {3, 4, 5}),
                    numbers = make_volume(SampleType::f32, {3, 4, 5});
  const std::string lines = "POINT_DATA 60\nCOLOR_SCALARS v 1\n";
  const auto binary = directory.open(
      "a.vtk", to_bytes(legacy_start("BINARY", bytes.size) + lines) + bytes.stored());
  expect_volume(*binary, bytes);
  const auto text =
      directory.open("b.vtk", legacy_start("ASCII", bytes.size) + lines + as_text(numbers));
  expect_volume(*text, numbers);
  EXPECT_EQ(text->info().scale, (ValueScale{255, 0}));
}

TEST(VtkLegacy, HeadersAsOthersWriteThem) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::i16, {3, 4, 5});
  const auto info = [&](const std::string& lines) {
    return directory
        .open("a.vtk", to_bytes("# vtk DataFile Version 1.0\n\nBINARY\r\n" + lines +
                                "POINT_DATA 60\nSCALARS v short\nLOOKUP_TABLE default\n") +
                           volume.stored(std::endian::big))
        ->info();
  };
  const VolumeInfo old = info(
      "dataset structured_points\norigin -1 0 1e3\n\ndimensions 3 4 5\naspect_ratio 1.0 2.0 -3\n");
  EXPECT_EQ(old.geometry.spacing, (Vec3{1, 2, 3}));
  EXPECT_EQ(old.geometry.origin, (Vec3{-1, 0, 1000}));
  EXPECT_THAT(old.warnings, ElementsAre(HasSubstr("a spacing of -3 is taken as 3")));
  const VolumeInfo extent = info("DATASET STRUCTURED_POINTS\nEXTENT 2 4 -3 0 0 4\nSPACING 1 2 3\n");
  EXPECT_EQ(extent.geometry.origin, (Vec3{2, -6, 0}));
  const VolumeInfo bare = info("DATASET STRUCTURED_POINTS\nDIMENSIONS 3 4 5\n");
  EXPECT_EQ(bare.geometry.spacing, (Vec3{1, 1, 1}));
}

TEST(VtkLegacy, WhatCannotBeReadIsNamed) {
  const VolumeFolder directory;
  const Bytes good = legacy_file(make_volume(SampleType::u16, {3, 4, 5}), true);
  const std::string whole(reinterpret_cast<const char*>(good.data()), good.size());
  const auto say = [&](const std::string& start, const std::string& line) {
    return directory.complaint("a.vtk", with_line(whole, start, line));
  };
  EXPECT_EQ(directory.complaint("a.vtk", whole), "");
  expect_says(directory.complaint("a.vtk", "# VTK DataFile\n"), {"a.vtk: byte 0: not a VTK file"});
  expect_says(say("ASCII", "BINARY64"), {"ASCII or BINARY", "'BINARY64'"});
  expect_says(say("DATASET", "DATASET POLYDATA"),
              {"byte 41", "expected STRUCTURED_POINTS", "found 'DATASET POLYDATA'"});
  expect_says(say("DIMENSIONS", ""), {"before DATASET and DIMENSIONS"});
  expect_says(say("DIMENSIONS", "DIMENSIONS 3 4"), {"three sizes"});
  expect_says(say("DIMENSIONS", "DIMENSIONS 3 4 0"), {"positive sizes"});
  expect_says(say("DIMENSIONS", "DIMENSIONS 3 4 -5"), {"a whole number as word 4"});
  expect_says(say("DIMENSIONS", "DIMENSIONS 1000000000 1000000000 1000000000"),
              {"more than any file holds"});
  expect_says(say("DIMENSIONS", "DIMENSIONS 3 4 6"), {"60 values are announced", "expected 72"});
  expect_says(say("SPACING", "SPACING 1 2"), {"three numbers"});
  expect_says(say("POINT_DATA", "CELL_DATA 60"), {"the cells between points", "expected 24"});
  expect_says(say("SCALARS", "SCALARS v unsigned_short 3"), {"truncated", "numbers are missing"});
  expect_says(say("SCALARS", "SCALARS v string"), {"values of type string"});
  expect_says(say("SCALARS", "SCALARS v bit"), {"values of type bit"});
  expect_says(say("SCALARS", "SCALARS v"), {"a name, a type"});
  expect_says(say("SCALARS", "SCALARS v short 9999999999"), {"values a sample"});
  expect_says(say("LOOKUP_TABLE", ""), {"expected LOOKUP_TABLE"});
  expect_says(say("SCALARS", "VERTICES 1 2"), {"a keyword of the format"});
  expect_says(say("SCALARS", "FIELD f 99999999"), {"a.vtk"});
  expect_says(say("POINT_DATA", "FIELD f 1\nx 4611686018427387904 4 double\nPOINT_DATA 60"),
              {"no more values than a file holds"});
}

TEST(VtkLegacy, DamagedFiles) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {5, 4, 3});
  std::mt19937_64 random(3);
  for (const bool text : {false, true}) {
    Bytes whole = legacy_file(volume, text);
    for (int i = 0; i < 300; ++i) {
      Bytes other = whole;
      other[random() % 220] ^= static_cast<std::byte>(1U << random() % 8);
      directory.complaint("a.vtk", other);  // an error or none, but no crash
    }
    whole.resize(whole.size() - (text ? 8 : 1));
    directory.expect_cuts_refused("a.vtk", whole, 1);
  }
}

TEST(VtkLegacy, IronProtein) {
  VOXWELD_NEEDS_SHARED_DATA("vtk/ironProt.vtk");
  const auto source = open_path(shared_data("vtk/ironProt.vtk"));
  EXPECT_EQ(source->info().geometry.size, (Index3{68, 68, 68}));
  EXPECT_EQ(source->info().type, SampleType::u8);
  std::int64_t sum = 0;
  for (const std::byte value : read_box(*source, {{}, {68, 68, 68}}))
    sum += std::to_integer<std::int64_t>(value);
  EXPECT_EQ(sum, 4131089);  // as numpy sums the 68^3 bytes behind the header
}

}  // namespace
}  // namespace voxweld::testing
