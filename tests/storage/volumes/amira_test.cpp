#include <fmt/format.h>

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::pair<SampleType, const char*> amira_test_types[] = {
    {SampleType::u8, "byte"},  {SampleType::i16, "short"}, {SampleType::u16, "ushort"},
    {SampleType::i32, "int"},  {SampleType::f32, "float"}, {SampleType::f64, "double"},
    {SampleType::u32, "uint"}, {SampleType::i32, "int32"}};

// Runs of equal bytes and of others, as long as they may be.
Bytes byte_runs(const Bytes& data) {
  Bytes out;
  for (std::size_t i = 0; i < data.size();) {
    std::size_t same = 1;
    while (i + same < data.size() && same < 127 && data[i + same] == data[i]) ++same;
    if (same > 2) {
      out.push_back(static_cast<std::byte>(same));
      out.push_back(data[i]);
      i += same;
      continue;
    }
    std::size_t other = 0;
    while (i + other < data.size() && other < 127 &&
           !(i + other + 2 < data.size() && data[i + other] == data[i + other + 1] &&
             data[i + other] == data[i + other + 2]))
      ++other;
    out.push_back(static_cast<std::byte>(128 + other));
    out.insert(out.end(), data.begin() + static_cast<std::ptrdiff_t>(i),
               data.begin() + static_cast<std::ptrdiff_t>(i + other));
    i += other;
  }
  return out;
}

std::string amira_start(const std::string& form, Index3 size) {
  return fmt::format(
      "# AmiraMesh {}\n\n# a remark with @1 in it\ndefine Lattice {} {} {}\n\nParameters {{\n"
      "    Content \"a {{ text, more\",\n    BoundingBox 1 {} 2 {} 3 {},\n"
      "    CoordType \"uniform\"\n}}\n\n",
      form, size.x, size.y, size.z, static_cast<double>(size.x),
      2 + 2.0 * static_cast<double>(size.y - 1), 3 + 0.5 * static_cast<double>(size.z - 1));
}

Bytes amira_file(const std::string& form, const KnownVolume& volume, const std::string& type,
                 const std::string& codec, const Bytes& data) {
  const std::string packing = codec.empty() ? "" : fmt::format("({},{})", codec, data.size());
  return to_bytes(amira_start(form, volume.size) +
                  fmt::format("Lattice {{ {} Data }} @1{}\n\n# Data section follows\n@1\n", type,
                              packing)) +
         data + to_bytes("\n");
}

// Random values, and a stretch of equal ones, for runs of both kinds.
KnownVolume amira_volume(SampleType type, Index3 size) {
  KnownVolume volume = make_volume(type, size);
  const auto width = static_cast<std::ptrdiff_t>(sample_bytes(type));
  std::fill(volume.samples.begin() + 10 * width, volume.samples.begin() + 150 * width, std::byte{});
  return volume;
}

TEST(Amira, EveryTypeOrderAndCompression) {
  const VolumeFolder directory;
  for (const auto& [type, name] : amira_test_types)
    for (const std::endian order : {std::endian::little, std::endian::big})
      for (const char* codec : {"", "HxByteRLE", "HxZip"}) {
        const KnownVolume volume = amira_volume(type, {6, 5, 7});
        const std::string form = order == std::endian::little ? "BINARY-LITTLE-ENDIAN 2.1"
                                 : codec[0] == 0              ? "BINARY 1.0"
                                                              : "3D BINARY 2.0";
        const Bytes stored = volume.stored(order);
        const Bytes data = codec[0] == 0     ? stored
                           : codec[2] == 'Z' ? deflated(stored)
                                             : byte_runs(stored);
        const auto source = directory.open("a.am", amira_file(form, volume, name, codec, data));
        const VolumeInfo& info = source->info();
        EXPECT_EQ(info.format, "amira");
        EXPECT_EQ(info.type, type);
        EXPECT_EQ(info.access, codec[0] == 0 ? Access::box : Access::stream);
        EXPECT_EQ(info.geometry.spacing, (Vec3{1, 2, 0.5}));
        EXPECT_EQ(info.geometry.origin, (Vec3{1, 2, 3}));
        EXPECT_EQ(info.warnings.size(), 0U);
        for (int pass = 0; pass < 2; ++pass)
          for (std::int64_t z = pass; z < 7; z += 2) {
            const Box3 slice{{0, 0, z}, {6, 5, z + 1}};
            ASSERT_EQ(read_box(*source, slice), volume.box(slice)) << name << codec;
          }
        if (codec[0] == 0) expect_volume(*source, volume);
      }
}

TEST(Amira, TextOfEveryType) {
  const VolumeFolder directory;
  for (const auto& [type, name] : amira_test_types) {
    const KnownVolume volume = make_volume(type, {6, 5, 7});
    for (const std::string form : {"3D ASCII 2.0", "ASCII 1.0"})
      expect_volume(*directory.open("a.am", amira_file(form, volume, name, "",
                                                       to_bytes(as_text(volume, "\n")))),
                    volume);
  }
}

TEST(Amira, OneOfSeveralArrays) {
  const VolumeFolder directory;
  const Index3 size{6, 5, 7};
  const KnownVolume first = amira_volume(SampleType::u8, size),
                    second = make_volume(SampleType::f32, size),
                    third = make_volume(SampleType::u16, size);
  for (const bool text : {false, true}) {
    const auto data = [&](const KnownVolume& volume) {
      return (text ? to_bytes(as_text(volume)) : volume.stored()) + to_bytes("\n\n");
    };
    const Bytes runs = byte_runs(first.stored());
    const std::string packing = text ? "" : fmt::format("(HxByteRLE, {}  )", runs.size());
    const Bytes whole =
        to_bytes(amira_start(text ? "3D ASCII 3.0" : "BINARY-LITTLE-ENDIAN 3.0", size) +
                 "define Points 2\nLattice { byte Labels } = @1" + packing +
                 "\nPoints { float[3] Places } @2\nLattice { float Data }@3 Lattice { ushort "
                 "Other } @4\n# Data\n@1\n") +
        (text ? data(first) : runs + to_bytes("\n")) + to_bytes("@2\n") +
        (text ? to_bytes("1 2 3 4 5 6\n") : Bytes(24, std::byte{'@'}) + to_bytes("\n")) +
        to_bytes("@3\n") + data(second) + to_bytes("@4\n") + data(third);
    const std::string path = write_file(directory / "a.am", whole).string();
    const auto open = [&](const std::string& dataset) {
      return open_volume({.path = path, .select = {.dataset = dataset}});
    };
    const Box3 all{{}, size};
    EXPECT_EQ(read_box(*open("Labels"), all), first.samples);
    EXPECT_EQ(read_box(*open("Data"), all), second.samples);
    EXPECT_EQ(read_box(*open("Other"), all), third.samples);
    ASSERT_EQ(open("Data")->info().choices.size(), 3U);
    EXPECT_TRUE(open("Data")->info().choices[1].chosen);
    expect_says(complaint(path), {"3 arrays: 'Labels' (byte), 'Data' (float), 'Other' (ushort)"});
    const auto shown = open_volume({.path = path, .survey = true});
    EXPECT_THAT(shown->info().warnings, ElementsAre(HasSubstr("the first of 3 arrays")));
  }
}

TEST(Amira, HeadersAsOthersWriteThem) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 1});
  const auto info = [&](const std::string& lines) {
    return directory
        .open("a.am", to_bytes("# Avizo BINARY-LITTLE-ENDIAN 2.1\r\n" + lines +
                               "\r\nLattice { byte Labels } @1\r\n@1\r\n") +
                          volume.stored())
        ->info();
  };
  const VolumeInfo bare = info("nLattice 3 4 1");
  EXPECT_EQ(bare.geometry.spacing, (Vec3{1, 1, 1}));
  EXPECT_THAT(bare.warnings, ElementsAre(HasSubstr("no CoordType"), HasSubstr("no BoundingBox")));
  const VolumeInfo labels = info(
      "define Lattice 3 4 1\nParameters { Materials { Exterior { Id 1, } Inside { Color 1 0 0 "
      "Inner { BoundingBox 1 } } }\nUnits { Coordinates \"microns\" }\nBoundingBox 0 4 0 9 5 5 "
      "CoordType \"uniform\" }");
  EXPECT_EQ(labels.geometry.spacing, (Vec3{2, 3, 1}));
  EXPECT_EQ(labels.geometry.origin, (Vec3{0, 0, 5}));
  EXPECT_EQ(labels.geometry.unit, "um");
  EXPECT_THAT(labels.warnings, ElementsAre(HasSubstr("a spacing of 0 is taken as 1"),
                                           HasSubstr("not taken over: 0 Exterior, 1 Inside")));
}

TEST(Amira, WhatCannotBeReadIsNamed) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  const Bytes file = amira_file("BINARY-LITTLE-ENDIAN 2.1", volume, "byte", "", volume.stored());
  const std::string good(reinterpret_cast<const char*>(file.data()), file.size());
  const auto say = [&](const std::string& what, const std::string& other) {
    std::string text = good;
    const std::size_t at = text.find(what);
    if (at == std::string::npos) throw std::runtime_error("no " + what);
    return directory.complaint("a.am", text.replace(at, what.size(), other));
  };
  EXPECT_EQ(directory.complaint("a.am", good), "");
  expect_says(say("AmiraMesh", "HyperMesh"), {"a.am:1: not an Amira file"});
  expect_says(say("BINARY-LITTLE-ENDIAN", "HEX"), {"a.am:1: expected ASCII, BINARY or"});
  expect_says(say("define Lattice", "define Vertices"), {"no 'define Lattice'"});
  expect_says(say("3 4 5", "3 4"), {"has 2 sizes: expected three"});
  expect_says(say("3 4 5", "3 4 -5"), {"a.am:4", "a size below 0"});
  expect_says(say("3 4 5", "3 4 0"), {"sizes must be positive"});
  expect_says(say("3 4 5", "3 4 6"), {"truncated"});
  expect_says(say("3 4 5", "3000000000 4000000000 5000000000"), {"more than any file holds"});
  expect_says(say("\"uniform\"", "\"stacked\""), {"CoordType 'stacked'"});
  expect_says(say("BoundingBox 1 3", "BoundingBox 1 x"), {"a.am:8: BoundingBox", "found 'x'"});
  expect_says(say("byte Data", "complex Data"), {"values of type complex"});
  expect_says(say("byte Data", "byte[3] Data"), {"3 values a sample"});
  expect_says(say("byte Data", "byte[x] Data"), {"a type such as float[3]"});
  expect_says(say("byte Data", "byte"), {"a.am:12"});
  expect_says(say("} @1", "} @1(HxZip,20)"), {"no gzip or zlib stream"});
  expect_says(say("} @1", "} @1(HxZap,20)"), {"compression 'HxZap'"});
  expect_says(say("} @1", "} @1(HxZip,x)"), {"the compressed size"});
  expect_says(say("} @1", "} @1(HxByteRLE,0)"), {"ends after 0 decoded bytes"});
  expect_says(say("} @1", "} @2"), {"@1, which comes before @2"});
  expect_says(say("} @1", "} 1"), {"expected @ and a number"});
  expect_says(say("\n@1\n", "\n"), {"truncated", "'@1'"});
  expect_says(say("Parameters {", "Parameters { {"), {"the header ends where }"});
}

TEST(Amira, DamagedFiles) {
  const VolumeFolder directory;
  const KnownVolume volume = amira_volume(SampleType::i16, {6, 5, 7});
  std::mt19937_64 random(3);
  const Bytes stored = volume.stored();
  for (const auto& [codec, data] :
       {std::pair{"", stored}, {"HxZip", deflated(stored)}, {"HxByteRLE", byte_runs(stored)}}) {
    Bytes whole = amira_file("BINARY-LITTLE-ENDIAN 2.1", volume, "short", codec, data);
    for (int i = 0; i < 300; ++i) {
      Bytes other = whole;
      other[random() % other.size()] ^= static_cast<std::byte>(1U << random() % 8);
      directory.complaint("a.am", other);  // an error or none, but no crash
    }
    whole.pop_back();
    directory.expect_cuts_refused("a.am", whole, 3);
  }
}

}  // namespace
}  // namespace voxweld::testing
