#include <fmt/format.h>

#include <map>

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const char* meta_type(SampleType type) {
  static const std::map<SampleType, const char*> names = {
      {SampleType::u8, "MET_UCHAR"},       {SampleType::i8, "MET_CHAR"},
      {SampleType::u16, "MET_USHORT"},     {SampleType::i16, "MET_SHORT"},
      {SampleType::u32, "MET_UINT"},       {SampleType::i32, "MET_LONG"},
      {SampleType::u64, "MET_ULONG_LONG"}, {SampleType::i64, "MET_LONG_LONG"},
      {SampleType::f32, "MET_FLOAT"},      {SampleType::f64, "MET_DOUBLE"}};
  return names.at(type);
}

std::string metaimage_header(const KnownVolume& volume, const std::string& more,
                             const std::string& data) {
  return fmt::format(
      "ObjectType = Image\nNDims = 3\nDimSize = {} {} {}\nElementType = {}\nElementSpacing = 1 2 "
      "0.5\n{}ElementDataFile = {}\n",
      volume.size.x, volume.size.y, volume.size.z, meta_type(volume.type), more, data);
}

TEST(MetaImage, EveryTypeOrderAndCompression) {
  const VolumeFolder directory;
  for (const SampleType type : all_types)
    for (const bool big : {false, true})
      for (const bool compressed : {false, true}) {
        const KnownVolume volume = make_volume(type, {6, 5, 7});
        Bytes data = volume.stored(big ? std::endian::big : std::endian::little);
        std::string more = fmt::format("ElementByteOrderMSB = {}\n", big ? "True" : "False");
        if (compressed) {
          data = deflated(data, Wrapper::zlib);
          more += fmt::format("CompressedData = True\nCompressedDataSize = {}\n", data.size());
        }
        const auto local =
            directory.open("a.mha", to_bytes(metaimage_header(volume, more, "LOCAL")) + data);
        expect_volume(*local, volume);
        EXPECT_EQ(local->info().access, compressed ? Access::stream : Access::box);
        EXPECT_TRUE(local->info().warnings.empty());
        write_file(directory / "the samples.raw", data);
        const auto beside =
            directory.open("a.mhd", metaimage_header(volume, more, "the samples.raw"));
        expect_volume(*beside, volume);
        EXPECT_EQ(beside->info().files.size(), 2U);
        EXPECT_EQ(beside->info().geometry.spacing, (Vec3{1, 2, 0.5}));
      }
}

TEST(MetaImage, TextSamples) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::i16, {6, 5, 7});
  const std::string text =
      metaimage_header(volume, "BinaryData = False\n", "LOCAL") + as_text(volume);
  expect_volume(*directory.open("a.mha", text), volume);
}

TEST(MetaImage, FilesByListAndPattern) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {4, 3, 5});
  std::string list;
  for (std::size_t z = 0; z < 5; ++z) {
    const std::string name = fmt::format("s{:02}.raw", 2 * z + 1);
    write_file(directory / name, volume.share(z, 5, std::endian::big));
    list += name + "\n";
  }
  const std::string order = "BinaryDataByteOrderMSB = True\n";
  for (const std::string& files :
       {"LIST\n" + list, "LIST 2\n" + list, "LIST 2D\n" + list, std::string("s%02d.raw 1 9 2")}) {
    const auto source = directory.open("a.mhd", metaimage_header(volume, order, files));
    expect_volume(*source, volume);
    EXPECT_EQ(source->info().files.size(), 6U);
  }
  const auto say = [&](const std::string& files) {
    return directory.complaint("a.mhd", metaimage_header(volume, order, files));
  };
  EXPECT_THAT(say("LIST\ns01.raw\n"), AllOf(HasSubstr("1 files are listed"), HasSubstr("5")));
  EXPECT_THAT(say("LIST x\ns01.raw\n"), HasSubstr("expected LIST"));
  EXPECT_THAT(say("s%02d.raw 1 9 1"), HasSubstr("names 9 files"));
  EXPECT_THAT(say("s%02s.raw 1 9 2"), HasSubstr("a.mhd:7: field 'ElementDataFile'"));
  EXPECT_THAT(say("s%02d.raw 1 9 two"), HasSubstr("first, last and step"));
  EXPECT_THAT(say("s%03d.raw 1 9 2"), HasSubstr("s001.raw is not there"));
}

TEST(MetaImage, HeaderSize) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {4, 3, 5});
  write_file(directory / "d.raw", Bytes(13, std::byte{1}) + volume.stored());
  for (const char* size : {"13", "-1"})
    expect_volume(
        *directory.open("a.mhd",
                        metaimage_header(volume, fmt::format("HeaderSize = {}\n", size), "d.raw")),
        volume);
  write_file(directory / "d.raw",
             Bytes(13, std::byte{1}) + deflated(volume.stored(), Wrapper::zlib));
  expect_volume(
      *directory.open(
          "a.mhd", metaimage_header(volume, "CompressedData = True\nHeaderSize = 13\n", "d.raw")),
      volume);
  EXPECT_THAT(
      directory.complaint(
          "a.mhd", metaimage_header(volume, "CompressedData = True\nHeaderSize = -1\n", "d.raw")),
      HasSubstr("-1 has no meaning"));
  EXPECT_THAT(directory.complaint("a.mhd", metaimage_header(volume, "HeaderSize = -2\n", "d.raw")),
              HasSubstr("'-2'"));
}

TEST(MetaImage, Geometry) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  const auto info = [&](const std::string& more) {
    return directory
        .open("a.mha", to_bytes(metaimage_header(volume, more, "LOCAL")) + volume.stored())
        ->info();
  };
  // The first three numbers are where x goes.
  VolumeInfo made =
      info("TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 5 6 -7\nDistanceUnits = mm\n");
  EXPECT_EQ(made.geometry.direction,
            (std::array<Vec3, 3>{Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}}));
  EXPECT_EQ(made.geometry.spacing, (Vec3{1, 2, 0.5}));
  EXPECT_EQ(made.geometry.origin, (Vec3{5, 6, -7}));
  EXPECT_EQ(made.geometry.unit, "mm");
  EXPECT_EQ(made.geometry.space, "LPS");
  made = info("Orientation = 1 0 0 0 1 0 0 0 1\nPosition = 1 2 3\nDistanceUnits = ?\n");
  EXPECT_EQ(made.geometry.origin, (Vec3{1, 2, 3}));
  EXPECT_EQ(made.geometry.unit, "");
  const std::string plain =
      with_line(metaimage_header(volume, "", "LOCAL"), "ElementSpacing", "ElementSize = 3 4 5");
  EXPECT_EQ(directory.open("a.mha", to_bytes(plain) + volume.stored())->info().geometry.spacing,
            (Vec3{3, 4, 5}));
}

TEST(MetaImage, FourthDimensionOfOne) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  const std::string text =
      "NDims = 4\nDimSize = 3 4 5 1\nElementType = MET_UCHAR\nElementSpacing = 1 2 3 1\n"
      "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\nOffset = 1 2 3 0\nElementDataFile = "
      "LOCAL\n";
  const auto source = directory.open("a.mha", to_bytes(text) + volume.stored());
  expect_volume(*source, volume);
  EXPECT_EQ(source->info().geometry.spacing, (Vec3{1, 2, 3}));
  EXPECT_THAT(directory.complaint("a.mha", with_line(text, "DimSize", "DimSize = 3 4 5 2")),
              AllOf(HasSubstr("a.mha:2"), HasSubstr("series are not supported")));
}

TEST(MetaImage, WarnsOfWhatItOverlooks) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {3, 4, 5});
  const auto source = directory.open(
      "a.mha", to_bytes(metaimage_header(volume,
                                         "CompressedData = True\nCompressedDataSize = 77\n"
                                         "ElementToIntensityFunctionSlope = 1\n"
                                         "ElementToIntensityFunctionOffset = -1024\n",
                                         "LOCAL")) +
                   deflated(volume.stored(), Wrapper::zlib));
  expect_volume(*source, volume);
  EXPECT_THAT(source->info().warnings,
              ::testing::ElementsAre(HasSubstr("little-endian assumed"), HasSubstr("says 77")));
  EXPECT_EQ(source->info().scale, (ValueScale{1, -1024}));
}

TEST(MetaImage, GivesSlopeAndIntercept) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {3, 4, 5});
  const auto opened = [&](const std::string& slope) {
    return directory
        .open("a.mha", to_bytes(metaimage_header(volume,
                                                 "ElementByteOrderMSB = False\n"
                                                 "ElementToIntensityFunctionSlope = " +
                                                     slope + "\n",
                                                 "LOCAL")) +
                           volume.stored())
        ->info();
  };
  EXPECT_EQ(opened("0.25").scale, (ValueScale{0.25, 0}));
  EXPECT_TRUE(opened("0").scale.identity());
  EXPECT_THAT(opened("nan").warnings,
              ::testing::ElementsAre(AllOf(HasSubstr("by nan"), HasSubstr("as stored"))));
}

TEST(MetaImage, TruncatedDataAreRefused) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {6, 5, 7});
  for (const bool compressed : {false, true}) {
    const Bytes head = to_bytes(
        metaimage_header(volume,
                         compressed ? "ElementByteOrderMSB = False\nCompressedData = True\n"
                                    : "ElementByteOrderMSB = False\n",
                         "LOCAL"));
    directory.expect_cuts_refused(
        "a.mha", head + (compressed ? deflated(volume.stored(), Wrapper::zlib) : volume.stored()),
        5);
  }
}

TEST(MetaImage, BadHeadersAreNamedWithTheirLine) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  const std::string good =
      metaimage_header(volume, "ElementNumberOfChannels = 1\nOffset = 0 0 0\n", "LOCAL");
  const auto say = [&](const std::string& text) {
    return directory.complaint("a.mha", to_bytes(text) + volume.stored());
  };
  const auto refused = [&](const std::string& start, const std::string& line,
                           std::initializer_list<std::string> parts) {
    expect_says(say(with_line(good, start, line)), parts);
  };
  EXPECT_EQ(say(good), "");
  EXPECT_THAT(say(with_line("\n" + good, "ObjectType", "ObjectType = Mesh")), HasSubstr("'Mesh'"));
  refused("NDims", "NDims = 2", {"a.mha:2: field 'NDims'"});
  refused("DimSize", "DimSize = 3 4", {"3 whole numbers"});
  refused("DimSize", "DimSize = 3 0 5", {"positive"});
  refused("DimSize", "DimSize = 9000000000 9000000000 9000000000", {"more than any file holds"});
  refused("DimSize", "no equals sign", {"a.mha:3: expected 'Key = Value'"});
  refused("ElementType", "", {"no field 'ElementType'"});
  refused("ElementType", "ElementType = MET_UCHAR_ARRAY", {"one number a sample"});
  refused("ElementSpacing", "ElementSpacing = 1 1", {"3 numbers"});
  refused("ElementNumberOfChannels", "ElementNumberOfChannels = 3", {"3 channels a sample"});
  refused("Offset", "TransformMatrix = 1 0 0 1 0 0 0 0 1", {"one plane"});
  refused("Offset", "TransformMatrix = 0 0 0 1 0 0 0 0 1", {"not zero"});
  refused("Offset", "Offset = 1 nan 2", {"finite"});
  refused("Offset", "CompressedData = maybe", {"True or False"});
  refused("Offset", "CompressedData = True", {"no gzip or zlib stream"});
  refused("ElementDataFile", "ElementDataFile = gone.raw", {"gone.raw is not there"});
  refused("ElementDataFile", "ElementDataFile =", {"a file name"});
}

}  // namespace
}  // namespace voxweld::testing
