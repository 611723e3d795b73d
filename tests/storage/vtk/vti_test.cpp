#include "tests/storage/vtk/vti_file.h"

namespace voxweld::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<VtiForm> binary_forms() {
  std::vector<VtiForm> forms;
  for (const char* codec : {"", "ZLib", "LZ4", "LZMA"})
    for (const std::size_t word_bytes : {4, 8})
      for (const std::endian order : {std::endian::little, std::endian::big})
        for (const auto& [format, base64] :
             {std::pair{"binary", true}, {"appended", true}, {"appended", false}})
          forms.push_back({format, base64, codec, word_bytes, order, 100});
  return forms;
}

std::string form_text(const VtiForm& form) {
  return fmt::format("{} {} {} {} {}", form.format, form.base64, form.codec, form.word_bytes,
                     form.order == std::endian::little ? "little" : "big");
}

TEST(Vti, EveryTypeOrderEncodingAndCompressor) {
  const VolumeFolder directory;
  for (const SampleType type : all_types)
    for (const VtiForm& form : binary_forms()) {
      SCOPED_TRACE(form_text(form));
      const KnownVolume volume = make_volume(type, {6, 5, 7});
      const auto source = directory.open("a.vti", vti_file(volume, form));
      expect_volume(*source, volume);
      const VolumeInfo& info = source->info();
      EXPECT_EQ(info.format, "vti");
      EXPECT_EQ(info.access, Access::box);
      EXPECT_EQ(info.geometry.spacing, (Vec3{1, 2, 0.5}));
      EXPECT_EQ(info.geometry.origin, (Vec3{1, 2, 3}));
      EXPECT_EQ(info.warnings.size(), 0U);
      EXPECT_EQ(info.files.size(), 1U);
      EXPECT_EQ(info.choices.size(), 0U);
    }
}

TEST(Vti, TextOfEveryType) {
  const VolumeFolder directory;
  for (const SampleType type : all_types) {
    const KnownVolume volume = make_volume(type, {6, 5, 7});
    const auto source = directory.open("a.vti", vti_file(volume, {.format = "ascii"}));
    expect_volume(*source, volume);
    EXPECT_EQ(source->info().access, Access::stream);
    EXPECT_EQ(source->info().warnings.size(), 0U);
  }
}

// Rows longer and shorter than blocks, blocks that end where the samples do, wide volumes.
TEST(Vti, BlocksOfAnySize) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {150, 6, 5});
  for (const std::size_t block : {2, 300, 301, 1799, 9000, 100'000}) {
    const VtiForm form{.codec = "LZ4", .block = block};
    const auto source = directory.open("a.vti", vti_file(volume, form));
    EXPECT_EQ(source->info().access, Access::chunks);
    EXPECT_GE(source->info().chunk.x * source->info().chunk.y * source->info().chunk.z * 2,
              static_cast<std::int64_t>(std::min(block, volume.samples.size())));
    std::mt19937_64 random(5);
    for (int i = 0; i < 60; ++i) {
      const Box3 box = random_box(volume.size, random);
      ASSERT_EQ(read_box(*source, box), volume.box(box)) << block;
    }
    EXPECT_EQ(read_box(*source, {{}, volume.size}), volume.samples);
  }
}

// Some writers encode the length by itself.
TEST(Vti, LengthApartFromTheSamples) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::i32, {6, 5, 7});
  for (const std::size_t word_bytes : {4, 8}) {
    const VtiForm form{.format = "binary", .word_bytes = word_bytes};
    std::string text = vti_file(volume, form);
    const std::string together = stored_array(volume.stored(), form);
    text.replace(text.find(together), together.size(),
                 base64_of(words_of({volume.samples.size()}, form)) + base64_of(volume.stored()));
    expect_volume(*directory.open("a.vti", text), volume);
  }
}

TEST(Vti, Geometry) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  const auto info = [&](const std::string& lattice, const std::string& extent) {
    return directory.open("a.vti", vti_file({{"v", volume}}, {}, lattice, extent))->info();
  };
  const VolumeInfo bare = info("", "0 2 0 3 0 4");
  EXPECT_EQ(bare.geometry.spacing, (Vec3{1, 1, 1}));
  EXPECT_EQ(bare.geometry.origin, (Vec3{0, 0, 0}));
  // x is the world's y and so on: columns of the matrix are the axes.
  const VolumeInfo turned = info(
      "Origin=\"10 20 30\" Spacing=\"0.1 2 3\" Direction=\"0 0 1 1 0 0 0 1 0\"", "4 6 -2 1 0 4");
  EXPECT_EQ(turned.geometry.spacing, (Vec3{0.1, 2, 3}));
  EXPECT_EQ(turned.geometry.direction[0], (Vec3{0, 1, 0}));
  EXPECT_EQ(turned.geometry.direction[1], (Vec3{0, 0, 1}));
  EXPECT_EQ(turned.geometry.direction[2], (Vec3{1, 0, 0}));
  EXPECT_DOUBLE_EQ(turned.geometry.origin.x, 10);
  EXPECT_DOUBLE_EQ(turned.geometry.origin.y, 20 + 4 * 0.1);
  EXPECT_DOUBLE_EQ(turned.geometry.origin.z, 30 - 2 * 2);
  EXPECT_THAT(info("Spacing=\"-2 0 1\"", "0 2 0 3 0 4").warnings,
              ElementsAre(HasSubstr("a spacing of -2 is taken as 2"),
                          HasSubstr("a spacing of 0 is taken as 1")));
}

TEST(Vti, ValuesInCellsLieInTheirMiddles) {
  const VolumeFolder directory;
  const KnownVolume cells = make_volume(SampleType::i16, {3, 4, 5});
  const auto source = directory.open(
      "a.vti",
      vti_file({{"c", cells, true}}, {}, "Origin=\"10 20 30\" Spacing=\"2 4 6\"", "1 4 0 4 0 5"));
  expect_volume(*source, cells);
  EXPECT_EQ(source->info().geometry.origin, (Vec3{13, 22, 33}));
  EXPECT_THAT(source->info().warnings, ElementsAre(HasSubstr("middle of cells")));
}

TEST(Vti, OneOfSeveralArrays) {
  const VolumeFolder directory;
  const KnownVolume first = make_volume(SampleType::u8, {3, 4, 5}, 1),
                    second = make_volume(SampleType::f32, {3, 4, 5}, 2),
                    cells = make_volume(SampleType::i16, {2, 3, 4}, 3);
  for (const char* format : {"appended", "binary", "ascii"}) {
    const auto write = [&](const std::string& scalars) {
      return write_file(directory / "a.vti",
                        vti_file({{"one", first}, {"two", second}, {"in", cells, true}},
                                 {.format = format}, "", "0 2 0 3 0 4", scalars));
    };
    const std::string path = write("").string();
    const auto open = [&](const std::string& dataset) {
      return open_volume({.path = path, .select = {.dataset = dataset}});
    };
    expect_volume(*open("one"), first);
    expect_volume(*open("two"), second);
    expect_volume(*open("cells/in"), cells);
    const VolumeInfo info = open("two")->info();
    ASSERT_EQ(info.choices.size(), 3U);
    EXPECT_EQ(info.choices[1].value, "two");
    EXPECT_EQ(info.choices[1].selector, "dataset");
    EXPECT_TRUE(info.choices[1].chosen);
    EXPECT_FALSE(info.choices[0].chosen);
    EXPECT_EQ(info.choices[2].value, "cells/in");
    expect_says(complaint(path), {"3 arrays", "'one' (UInt8), 'two' (Float32), 'cells/in'",
                                  "set input.dataset or --dataset"});
    expect_says(complaint({.path = path, .select = {.dataset = "three"}}),
                {"no array 'three'", "'one'"});
    const auto shown = open_volume({.path = path, .survey = true});
    expect_volume(*shown, first);
    EXPECT_THAT(shown->info().warnings, ElementsAre(HasSubstr("the first of 3 arrays")));
    write("Scalars=\"two\"");
    expect_volume(*open_path(path), second);
  }
}

TEST(Vti, WhatCannotBeReadIsNamed) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {3, 4, 5});
  const std::string good = vti_file(volume, {.codec = "ZLib"});
  const auto say = [&](const std::string& what, const std::string& other) {
    std::string text = good;
    const std::size_t at = text.find(what);
    if (at == std::string::npos) throw std::runtime_error("no " + what);
    return directory.complaint("a.vti", text.replace(at, what.size(), other));
  };
  EXPECT_EQ(directory.complaint("a.vti", good), "");
  expect_says(say("\"ImageData\"", "\"PImageData\""), {"a.vti", "pieces in other files"});
  expect_says(say("\"ImageData\"", "\"PolyData\""), {"type 'PolyData': expected ImageData"});
  expect_says(say("vtkZLib", "vtkBest"), {"attribute compressor", "found 'vtkBestData"});
  expect_says(say("LittleEndian", "Middle"), {"attribute byte_order", "'Middle'"});
  expect_says(say("UInt32", "UInt128"), {"header_type", "'UInt128'"});
  expect_says(say("UInt16", "String"), {"values of type String"});
  expect_says(say("Name=\"v\"", "Name=\"v\" NumberOfComponents=\"3\""), {"3 values a sample"});
  expect_says(say("Extent=\"0 2", "Extent=\"0 x"), {"WholeExtent", "six whole numbers"});
  expect_says(say("Extent=\"0 2", "Extent=\"3 2"), {"no last index below the first"});
  expect_says(say("Extent=\"0 2", "Extent=\"0 3"), {"Piece, attribute Extent: expected the Whole"});
  expect_says(say("Spacing=\"1 2", "Spacing=\"1"), {"attribute Spacing: expected 3 numbers"});
  expect_says(say("Spacing=\"1", "Direction=\"1 0 0 1 0 0 0 0 1\" Spacing=\"1"),
              {"axis", "must be finite and not zero"});
  expect_says(say("offset=\"0\"", "offset=\"-1\""), {"attribute offset"});
  expect_says(say("offset=\"0\"", "offset=\"10000\""), {"truncated"});
  expect_says(say("\"raw\"", "\"hex\""), {"encoding: expected raw or base64"});
  expect_says(say("\"appended\"", "\"xdmf\""), {"ascii, binary or appended"});
  expect_says(say("</Piece>", "</Piece><Piece/>"), {"several pieces"});
  expect_says(say("</Piece>", ""), {"the XML is damaged"});
  expect_says(say("<!-- a > b -->", "<!DOCTYPE x>"), {"document types"});
  expect_says(say("<!-- a > b -->", "<!-- a > b --"), {"truncated"});
  // A header that lies about sizes.
  const auto lies = [&](const std::vector<std::uint64_t>& words) {
    const std::string table = to_text(words_of(words, {}));
    std::string text = good;
    return directory.complaint("a.vti", text.replace(text.find("   _") + 4, table.size(), table));
  };
  expect_says(lies({1, 32768, 121, 50}), {"120 bytes of samples were announced"});
  expect_says(lies({0, 0, 0}), {"no blocks"});
  expect_says(lies({1, 100, 120}), {"last block is larger"});
  expect_says(lies({0xffffffff, 0xffffffff, 0}), {"more bytes than any"});
  expect_says(lies({120, 1, 0}), {"truncated"});
  expect_says(lies({1, 120, 0, 0xffffffff}), {"do not decode to 120"});
  expect_says(lies({1, 120, 0, 30}), {"block 0 of 1: zlib"});
}

TEST(Vti, LargeBlocksAreRefused) {
  const VolumeFolder directory;
  KnownVolume volume = make_volume(SampleType::u8, {1, 1, 1});
  const std::string size = "0 1023 0 1023 0 99";
  std::string text = vti_file({{"v", volume}}, {.codec = "ZLib"}, "", size);
  const std::string words =
      to_text(words_of({1, std::uint64_t{100} << 20, 0, std::uint64_t{1} << 20}, {}));
  text.replace(text.find("   _") + 4, words.size(), words);
  expect_says(directory.complaint("a.vti", text), {"blocks larger than", "write smaller ones"});
}

TEST(Vti, DamagedFiles) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {5, 4, 3});
  std::vector<VtiForm> forms = binary_forms();
  forms.push_back({.format = "ascii"});
  std::mt19937_64 random(3);
  for (const VtiForm& form : forms) {
    SCOPED_TRACE(form_text(form));
    const Bytes whole = to_bytes(vti_file(volume, form));
    const std::string text = to_text(whole);
    // Behind the samples an end may be missing: of appended data nothing is looked at there.
    const std::size_t needed =
        form.format == "appended" ? text.find("\n  </AppendedData>") : text.find("</VTKFile>");
    const std::size_t step = form.order == std::endian::big ? 31 : 7;
    directory.expect_cuts_refused(
        "a.vti", {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(needed)}, step);
    for (int i = 0; i < 40; ++i) {
      Bytes other = whole;
      other[random() % other.size()] ^= static_cast<std::byte>(1U << random() % 8);
      directory.complaint("a.vti", other);  // an error or none, but no crash
    }
  }
}

}  // namespace
}  // namespace voxweld::testing
