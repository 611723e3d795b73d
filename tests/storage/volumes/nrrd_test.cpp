#include <fmt/format.h>

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// A minimal header without its end; the rest is appended.
std::string nrrd_header(const KnownVolume& volume, const std::string& encoding,
                        const std::string& more = "") {
  return fmt::format(
      "NRRD0004\n# a comment\ntype: {}\ndimension: 3\nsizes: {} {} {}\nencoding: {}\n{}",
      sample_type_name(volume.type), volume.size.x, volume.size.y, volume.size.z, encoding, more);
}

TEST(Nrrd, EveryTypeOrderAndEncodingAttached) {
  const VolumeFolder directory;
  for (const SampleType type : all_types)
    for (const std::endian order : {std::endian::little, std::endian::big})
      for (const char* encoding : {"raw", "gzip", "gz"}) {
        const KnownVolume volume = make_volume(type, {6, 5, 7});
        Bytes data = volume.stored(order);
        if (encoding[0] == 'g') data = deflated(data, Wrapper::gzip);
        const std::string text = nrrd_header(
            volume, encoding, order == std::endian::big ? "endian: big\n\n" : "endian: little\n\n");
        const auto source = directory.open("a.nrrd", to_bytes(text) + data);
        expect_volume(*source, volume);
        EXPECT_EQ(source->info().access, encoding[0] == 'g' ? Access::stream : Access::box);
        EXPECT_EQ(source->info().files.size(), 1U);
        EXPECT_TRUE(source->info().warnings.empty());
      }
}

TEST(Nrrd, TextOfEveryType) {
  const VolumeFolder directory;
  for (const SampleType type : all_types) {
    const KnownVolume volume = make_volume(type, {6, 5, 7});
    for (const char* separator : {" ", ", ", "\t"}) {
      const std::string text = nrrd_header(volume, "ascii") + "\n" + as_text(volume, separator);
      expect_volume(*directory.open("a.nrrd", text), volume);
    }
  }
}

TEST(Nrrd, TextThatDoesNotFitTheTypeIsNamed) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {2, 2, 1});
  const auto say = [&](const std::string& samples) {
    return directory.complaint("a.nrrd", nrrd_header(volume, "text") + "\n" + samples);
  };
  EXPECT_EQ(say("1 2 3 4"), "");
  EXPECT_THAT(say("1 2 256 4"),
              AllOf(HasSubstr("sample 2"), HasSubstr("uint8"), HasSubstr("'256'")));
  EXPECT_THAT(say("1 -2 3 4"), HasSubstr("'-2'"));
  EXPECT_THAT(say("1 2 3.5 4"), HasSubstr("'3.5'"));
  EXPECT_THAT(say("1 2 3"), HasSubstr("ends after 3 samples"));
}

TEST(Nrrd, DetachedWithSkips) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::i16, {6, 5, 7});
  const auto text = [&](const std::string& encoding, const std::string& skips) {
    return nrrd_header(volume, encoding, "endian: little\ndata file: my data.bin\n" + skips);
  };
  const Bytes junk = to_bytes("first line\r\nsecond line\nabc");
  // Lines are skipped before decompression and bytes after.
  write_file(directory / "my data.bin", junk + volume.stored());
  expect_volume(*directory.open("a.nhdr", text("raw", "line skip: 2\nbyte skip: 3\n")), volume);
  expect_volume(*directory.open("a.nhdr", text("raw", "byteskip: -1\n")), volume);
  write_file(directory / "my data.bin",
             to_bytes("a line\n") + deflated(junk + volume.stored(), Wrapper::gzip));
  expect_volume(*directory.open("a.nhdr", text("gzip", fmt::format("line skip: 1\nbyte skip: {}\n",
                                                                   junk.size()))),
                volume);
  expect_volume(*directory.open("a.nhdr", text("gzip", "line skip: 1\nbyte skip: -1\n")), volume);
  EXPECT_THAT(directory.complaint("a.nhdr", text("raw", "byte skip: -5\n")),
              AllOf(HasSubstr("a.nhdr:9"), HasSubstr("'byte skip'"), HasSubstr("'-5'")));
  EXPECT_THAT(directory.complaint("a.nhdr", text("raw", "line skip: 1000\n")),
              HasSubstr("1000 lines to skip"));
}

TEST(Nrrd, FilesByListAndPattern) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {9, 8, 70});
  for (const bool compressed : {false, true}) {
    std::string list;
    for (std::size_t z = 0; z < 70; ++z) {
      Bytes share = to_bytes("x") + volume.share(z, 70, std::endian::big);
      if (compressed) share = deflated(share, Wrapper::gzip);
      const std::string name = fmt::format("slice_{:03}.bin", 100 - z);
      write_file(directory / name, share);
      list += name + "\n";
    }
    const std::string fields = "endian: big\nbyte skip: 1\n";
    const std::string encoding = compressed ? "gzip" : "raw";
    for (const std::string& files : {"data file: LIST\n" + list, "data file: LIST 2\n" + list,
                                     std::string("data file: slice_%03d.bin 100 31 -1\n"),
                                     std::string("datafile: slice_%03d.bin 100 31 -1 2\n")}) {
      const auto source = directory.open("a.nhdr", nrrd_header(volume, encoding, fields + files));
      expect_volume(*source, volume);
      EXPECT_EQ(source->info().files.size(), 71U);
    }
    EXPECT_THAT(directory.complaint(
                    "a.nhdr", nrrd_header(volume, encoding, fields + "data file: LIST\na\nb\n")),
                AllOf(HasSubstr("2 files are listed"), HasSubstr("70")));
    EXPECT_THAT(directory.complaint(
                    "a.nhdr", nrrd_header(volume, encoding, fields + "data file: s%d 1 9 1\n")),
                AllOf(HasSubstr("names 9 files"), HasSubstr("70")));
    EXPECT_THAT(directory.complaint(
                    "a.nhdr", nrrd_header(volume, encoding, fields + "data file: s%d 1 70 1\n")),
                AllOf(HasSubstr("a.nhdr:9"), HasSubstr("s1 is not there")));
  }
}

TEST(Nrrd, ManyFilesWarnOnce) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {9, 8, 7});
  for (std::size_t z = 0; z < 7; ++z)
    write_file(directory / fmt::format("s{}", z),
               volume.share(z, 7, std::endian::little) + Bytes(3));
  const auto source =
      directory.open("a.nhdr", nrrd_header(volume, "raw", "old min: -5\ndata file: s%d 0 6 1\n"));
  EXPECT_THAT(source->info().warnings,
              ::testing::ElementsAre(HasSubstr("stored units"),
                                     AllOf(HasSubstr("s0: 3 bytes after"), HasSubstr("6 more"))));
}

TEST(Nrrd, GeometryFromDirections) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  const auto source = directory.open(
      "a.nrrd",
      to_bytes(nrrd_header(
          volume, "raw",
          "space: left-posterior-superior\nspace directions: (0,2,0) (-3, 0, 0) (0,0,0.5)\n"
          "space origin: (10,20,-30.5)\nspace units: \"mm\" \"mm\" \"mm\"\n"
          "kinds: domain domain domain\nkey:=value: x\n\n")) +
          volume.stored());
  expect_volume(*source, volume);
  const VolumeGeometry& geometry = source->info().geometry;
  EXPECT_EQ(geometry.spacing, (Vec3{2, 3, 0.5}));
  EXPECT_EQ(geometry.direction,
            (std::array<Vec3, 3>{Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}}));
  EXPECT_EQ(geometry.origin, (Vec3{10, 20, -30.5}));
  EXPECT_EQ(geometry.unit, "mm");
  EXPECT_EQ(geometry.space, "LPS");
  EXPECT_TRUE(source->info().warnings.empty());
}

TEST(Nrrd, GeometryFromSpacings) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  const auto info = [&](const std::string& fields) {
    return directory
        .open("a.nrrd", to_bytes(nrrd_header(volume, "raw", fields + "\n")) + volume.stored())
        ->info();
  };
  VolumeInfo made = info("spacings: 0.5 2 3\nunits: \"um\" \"microns\" \"um\"\n");
  EXPECT_EQ(made.geometry.spacing, (Vec3{0.5, 2, 3}));
  EXPECT_EQ(made.geometry.unit, "um");
  made = info("spacings: 1 -2 nan\n");
  EXPECT_EQ(made.geometry.spacing, (Vec3{1, 2, 1}));
  EXPECT_EQ(made.geometry.direction[1], (Vec3{0, 1, 0}));
  EXPECT_EQ(made.warnings.size(), 2U);
  made = info("odd field: 3\nspace: 3D-left-handed\nspace directions: (1,0,0) (0.5,1,0) (0,0,1)\n");
  EXPECT_THAT(made.warnings,
              ::testing::ElementsAre(HasSubstr("unknown field"), HasSubstr("not perpendicular")));
  made = info("space: left-\xff\xffior\n");
  EXPECT_EQ(made.geometry.space, "");
  EXPECT_THAT(made.warnings, ::testing::ElementsAre(HasSubstr("not ASCII text")));
}

TEST(Nrrd, AxesOfSizeOneFallAway) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  const auto open = [&](const std::string& fields) {
    return directory.open(
        "a.nrrd",
        to_bytes("NRRD0005\ntype: uchar\nencoding: raw\n" + fields + "\n") + volume.stored());
  };
  expect_volume(*open("dimension: 4\nsizes: 3 4 5 1\n"), volume);
  expect_volume(*open("dimension: 4\nsizes: 1 3 4 5\nkinds: vector space space space\n"), volume);
  const auto source = open(
      "dimension: 4\nsizes: 1 3 4 5\nspace dimension: 3\n"
      "space directions: none (1,0,0) (0,2,0) (0,0,3)\n");
  expect_volume(*source, volume);
  EXPECT_EQ(source->info().geometry.spacing, (Vec3{1, 2, 3}));
  expect_volume(*open("dimension: 4\nsizes: 3 4 1 5\nspacings: 1 2 nan 3\nkinds: space space "
                      "list space\n"),
                volume);
}

TEST(Nrrd, TruncatedAndCorruptDataAreRefused) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {6, 5, 7});
  const Bytes text = to_bytes(nrrd_header(volume, "raw", "endian: little\n\n"));
  directory.expect_cuts_refused("a.nrrd", text + volume.stored(), 7);
  const Bytes head = to_bytes(nrrd_header(volume, "gzip", "endian: little\n\n"));
  const Bytes packed = head + deflated(volume.stored(), Wrapper::gzip);
  directory.expect_cuts_refused("a.nrrd", packed, 3, head.size());
  // The gzip checksum finds every flip in the samples, once the last slice has been read.
  for (std::size_t at = head.size() + 10; at < packed.size(); at += 5) {
    Bytes flipped = packed;
    flipped[at] ^= std::byte{4};
    EXPECT_THAT(directory.complaint("a.nrrd", flipped), HasSubstr("a.nrrd")) << at;
  }
}

// A bad read leaves the stream nowhere; the next one starts again instead of going on from there.
TEST(Nrrd, StreamsRestart) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {60, 50, 7});
  const Bytes text = to_bytes(nrrd_header(volume, "gzip", "endian: little\n\n"));
  const Bytes packed = text + deflated(volume.stored(), Wrapper::gzip);
  const auto source = directory.open("a.nrrd", packed);
  std::vector<std::byte> out(volume.samples.size());
  EXPECT_THROW(source->read({{0, 0, 0}, {60, 49, 2}}, out.data()), std::logic_error);
  expect_volume(*source, volume);
  const auto cut = directory.open("b.nrrd", std::span(packed).first(packed.size() / 2));
  EXPECT_THAT(cut->info().warnings, ::testing::ElementsAre(HasSubstr("truncated")));
  EXPECT_THROW(cut->read({{}, volume.size}, out.data()), FormatError);
  const Box3 first{{0, 0, 0}, {60, 50, 1}};
  EXPECT_EQ(read_box(*cut, first), volume.box(first));
}

TEST(Nrrd, JoinedGzipMembersAreOneStream) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {6, 5, 8});
  const Bytes text = to_bytes(nrrd_header(volume, "gzip", "endian: little\n\n"));
  const Bytes packed = text + deflated(volume.share(0, 2, std::endian::little), Wrapper::gzip) +
                       deflated(volume.share(1, 2, std::endian::little), Wrapper::gzip) +
                       to_bytes("trailing");
  expect_volume(*directory.open("a.nrrd", packed), volume);
}

TEST(Nrrd, BadHeadersAreNamedWithTheirLine) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::i16, {3, 4, 5});
  const std::string good = nrrd_header(volume, "raw", "endian: little\nspacings: 1 1 1\n\n");
  const auto say = [&](const std::string& text) {
    return directory.complaint("a.nrrd", to_bytes(text) + volume.stored());
  };
  const auto refused = [&](const std::string& start, const std::string& line,
                           std::initializer_list<std::string> parts) {
    expect_says(say(with_line(good, start, line)), parts);
  };
  EXPECT_EQ(say(good), "");
  EXPECT_THAT(say("NRRD0009\n" + good.substr(9)), HasSubstr("a.nrrd:1: NRRD version '0009'"));
  refused("type", "", {"no field 'type'"});
  refused("type", "type: block", {"opaque"});
  refused("type", "type: quad", {"a.nrrd:3", "'quad'"});
  refused("dimension", "dimension: 2", {"2-D data are not a volume"});
  refused("dimension", "dimension: 4", {"4 whole numbers"});
  refused("dimension", "dimension: x", {"found 'x'"});
  refused("sizes", "sizes: 3 4 -5", {"a.nrrd:5: field 'sizes'"});
  refused("sizes", "sizes: 3 4 five", {"'3 4 five'"});
  refused("sizes", "sizes: 3 4 5\nsizes: 3 4 5", {"a.nrrd:6", "given twice, first in line 5"});
  refused("sizes", "sizes: 9000000000 9000000000 9000000000", {"more than any file holds"});
  refused("sizes", "sizes: 3 4 6", {"truncated", "144"});
  refused("encoding", "encoding: bz2", {"compressed by bzip2", "no such stream"});
  refused("encoding", "encoding: hex", {"'hex' is not supported"});
  refused("encoding", "encoding: gzip", {"no gzip or zlib stream"});
  refused("endian", "", {"no field 'endian'"});
  refused("endian", "endian: middle", {"expected little or big"});
  refused("spacings", "space directions: (1,0,0) (0,0,0) (0,0,1)", {"step along axis 1"});
  refused("spacings", "spacings: 1 1", {"3 numbers"});
  refused("spacings", "spacings 1 1 1", {"a.nrrd:8: expected 'field: value'"});
  refused("spacings", "space directions: (1,0,0) (0,1,0) (1,1,0)", {"one plane"});
  refused("spacings", "space directions: (1,0,0) (0,1,0) (0,0,1", {"closed parentheses"});
  refused("spacings", "space directions: (1,0,0) (0,1,0)", {"3 entries"});
  refused("spacings", "space directions: (1,0) (0,1) (0,0)", {"world of 2 dimensions"});
  refused("spacings", "space directions: none (0,1,0) (0,0,1)", {"axis 0", "not supported"});
  refused("spacings", "kinds: RGB-color domain domain", {"'rgb-color'", "3 entries a sample"});
  refused("spacings", "spacings: 1 1 1\nunits: \"mm\" \"mm\" \"um\"", {"different units"});
  refused("spacings", "data file: gone.raw", {"gone.raw is not there"});
  EXPECT_THAT(
      say(with_line(with_line(good, "dimension", "dimension: 4"), "sizes", "sizes: 3 2 2 5")),
      HasSubstr("4 axes of space"));
}

}  // namespace
}  // namespace voxweld::testing
