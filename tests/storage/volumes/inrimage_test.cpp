#include <fmt/format.h>

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// Lines as they stand in the header, which is filled to whole blocks.
std::string inrimage_header(const std::string& lines) {
  std::string text = fmt::format("#INRIMAGE-4#{{\n{}", lines);
  text.append((256 - (text.size() + 4) % 256) % 256, '\n');
  text += "##}\n";
  return text;
}

std::string type_lines(SampleType type) {
  const std::string_view name = sample_type_name(type);
  const char* kind = name.starts_with("u")   ? "unsigned fixed"
                     : name.starts_with("i") ? "signed fixed"
                                             : "float";
  return fmt::format("TYPE={}\nPIXSIZE={} bits\n", kind, 8 * sample_bytes(type));
}

std::string lines_of(const KnownVolume& volume, const std::string& cpu) {
  return fmt::format("XDIM={}\nYDIM={}\nZDIM={}\nVDIM=1\n{}CPU={}\nVX=1\nVY=2\nVZ=0.5\n",
                     volume.size.x, volume.size.y, volume.size.z, type_lines(volume.type), cpu);
}

TEST(Inrimage, EveryTypeOrderAndCompression) {
  const VolumeFolder directory;
  for (const SampleType type : all_types)
    for (const std::string cpu : {"decm", "pc", "alpha", "sun", "sgi"})
      for (const bool compressed : {false, true}) {
        const KnownVolume volume = make_volume(type, {6, 5, 7});
        const bool big = cpu == "sun" || cpu == "sgi";
        Bytes data = to_bytes(inrimage_header(lines_of(volume, cpu))) +
                     volume.stored(big ? std::endian::big : std::endian::little);
        if (compressed) data = deflated(data, Wrapper::gzip);
        const auto source = directory.open(compressed ? "a.inr.gz" : "a.inr", data);
        expect_volume(*source, volume);
        const VolumeInfo& info = source->info();
        EXPECT_EQ(info.format, "inrimage");
        EXPECT_EQ(info.access, compressed ? Access::stream : Access::box);
        EXPECT_EQ(info.geometry.spacing, (Vec3{1, 2, 0.5}));
        EXPECT_EQ(info.geometry.unit, "");
        EXPECT_TRUE(info.warnings.empty());
        EXPECT_EQ(info.files.size(), 1U);
      }
}

// The header is known whatever the file is called, and may be of several blocks.
TEST(Inrimage, HeadersOfAnyLength) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {6, 5, 7});
  for (const std::size_t remark : {1, 100, 139, 140, 300, 5000}) {
    const std::string lines =
        fmt::format("{}# {}\n", lines_of(volume, "pc"), std::string(remark, 'x'));
    const auto source = directory.open("a.dat", to_bytes(inrimage_header(lines)) + volume.stored());
    expect_volume(*source, volume);
  }
}

TEST(Inrimage, Geometry) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {3, 4, 5});
  const auto info = [&](const std::string& lines) {
    return directory.open("a.inr", to_bytes(inrimage_header(lines)) + volume.stored())->info();
  };
  const std::string lines = lines_of(volume, "pc");
  EXPECT_EQ(info(lines + "TX=1.5\nTY=-2\nTZ=1e3\n").geometry.origin, (Vec3{1.5, -2, 1000}));
  const VolumeInfo bare = info(fmt::format("XDIM=3\r\nYDIM = 4\nZDIM=5\n{}\n#GEOMETRY=CARTESIAN\n",
                                           type_lines(SampleType::u16)));
  EXPECT_EQ(bare.geometry.spacing, (Vec3{1, 1, 1}));
  EXPECT_THAT(bare.warnings, ElementsAre(HasSubstr("no VX: taken as 1"), HasSubstr("no VY"),
                                         HasSubstr("no VZ"), HasSubstr("little-endian assumed")));
  EXPECT_TRUE(info(lines + "SCALE=2**0\nRX=0\n").warnings.empty());
  EXPECT_EQ(info(lines + "SCALE=2**-8\n").scale, (ValueScale{1.0 / 256, 0}));
  EXPECT_THAT(info(lines + "SCALE=3\nRZ=0.5\n").warnings,
              ElementsAre(HasSubstr("a.inr:13: field 'RZ': 0.5: rotations are ignored"),
                          HasSubstr("a.inr:12: field 'SCALE': 3: expected a power of two")));
}

TEST(Inrimage, WhatCannotBeReadIsNamed) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {3, 4, 5});
  const auto say = [&](const std::string& line_start, const std::string& line) {
    const std::string lines =
        with_line(fmt::format("\n{}", lines_of(volume, "pc")), line_start, line);
    return directory.complaint("a.inr", to_bytes(inrimage_header(lines)) + volume.stored());
  };
  const auto refused = [&](const std::string& start, const std::string& line,
                           std::initializer_list<std::string> parts) {
    expect_says(say(start, line), parts);
  };
  refused("XDIM", "", {"the header has no field 'XDIM'"});
  refused("YDIM", "YDIM=0", {"a.inr:4: field 'YDIM': expected a positive size"});
  refused("ZDIM", "ZDIM=5.0", {"expected a whole number, found '5.0'"});
  refused("ZDIM", "ZDIM=9000000000000000000", {"more than any file holds"});
  refused("VDIM", "VDIM=3", {"field 'VDIM': 3 values a sample: vectors"});
  refused("TYPE", "TYPE=packed", {"expected unsigned fixed, signed fixed or"});
  refused("TYPE", "TYPE=float", {"'PIXSIZE': expected 32 or 64 bits, found '16"});
  refused("PIXSIZE", "PIXSIZE=12 bits", {"expected 8, 16, 32 or 64 bits"});
  refused("PIXSIZE", "PIXSIZE=16 bytes", {"found '16 bytes'"});
  EXPECT_EQ(say("PIXSIZE", "PIXSIZE=16"), "");
  refused("CPU", "CPU=vax", {"decm, pc or alpha (little-endian) or sun or sgi"});
  refused("VY", "VY=wide", {"expected a number, found 'wide'"});
  refused("VZ", "VZ 1", {"a.inr:12: expected KEY=value"});
  refused("VZ", "VX=1", {"given twice, first in line 10"});
  refused("XDIM", "XDIM=4", {"truncated"});
}

TEST(Inrimage, DamagedFiles) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {3, 4, 5});
  const Bytes whole = to_bytes(inrimage_header(lines_of(volume, "pc"))) + volume.stored();
  const auto say = [&](std::span<const std::byte> bytes, const std::string& name = "a.inr") {
    return directory.complaint(name, bytes);
  };
  EXPECT_EQ(say(whole), "");
  for (const std::size_t length : {0, 3, 9})
    EXPECT_THAT(say(std::span(whole).first(length)), HasSubstr("a.inr: not an Inrimage"));
  for (const std::size_t length : {20, 255, 256, 300, 375})
    EXPECT_THAT(say(std::span(whole).first(length)),
                AllOf(HasSubstr("a.inr"), HasSubstr("truncated")))
        << length;
  Bytes other = whole;
  other[10] = std::byte{'5'};
  EXPECT_THAT(say(other), HasSubstr("an Inrimage of another version than 4"));
  other[1] = std::byte{'i'};
  EXPECT_THAT(say(other), HasSubstr("not an Inrimage: expected #INRIMAGE-4#{ first"));
  other = whole;
  other[253] = std::byte{'\n'};
  other.resize(100'000);
  EXPECT_THAT(say(other), HasSubstr("the header has no end within 65536 bytes"));
  const Bytes packed = deflated(whole, Wrapper::gzip);
  for (const std::size_t length : {std::size_t{12}, std::size_t{100}, packed.size() - 20})
    EXPECT_THAT(say(std::span(packed).first(length), "a.inr.gz"), HasSubstr("a.inr.gz"));
}

}  // namespace
}  // namespace voxweld::testing
