// Samples of NRRD compressed by bzip2, and shared by files of several slices each.
#include <bzlib.h>
#include <fmt/format.h>

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

using ::testing::HasSubstr;

Bytes bzipped(const Bytes& data) {
  Bytes out(data.size() * 2 + 1000);
  auto size = static_cast<unsigned>(out.size());
  Bytes input = data;
  if (BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(out.data()), &size,
                               reinterpret_cast<char*>(input.data()),
                               static_cast<unsigned>(input.size()), 1, 0, 0) != BZ_OK)
    throw std::runtime_error("BZ2_bzBuffToBuffCompress failed");
  out.resize(size);
  return out;
}

std::string parts_header(const KnownVolume& volume, const std::string& encoding,
                         const std::string& more) {
  return fmt::format("NRRD0004\ntype: {}\ndimension: 3\nsizes: {} {} {}\nencoding: {}\n{}",
                     sample_type_name(volume.type), volume.size.x, volume.size.y, volume.size.z,
                     encoding, more);
}

// Whose memory is a few MiB: more than expect_volume lets a stream have.
void expect_bzipped(const SampleSource& source, const KnownVolume& volume) {
  EXPECT_EQ(source.info().access, Access::stream);
  EXPECT_LT(source.info().largest_decode, std::uint64_t{5} << 20);
  EXPECT_EQ(source.info().type, volume.type);
  ASSERT_EQ(source.info().geometry.size, volume.size);
  const Index3 size = volume.size;
  for (int pass = 0; pass < 2; ++pass)
    for (std::int64_t z = pass; z < size.z; z += 2) {
      const Box3 slice{{0, 0, z}, {size.x, size.y, z + 1}};
      ASSERT_EQ(read_box(source, slice), volume.box(slice));
    }
}

TEST(NrrdBzip2, EveryTypeAndOrder) {
  const VolumeFolder directory;
  for (const SampleType type : all_types)
    for (const std::endian order : {std::endian::little, std::endian::big})
      for (const char* encoding : {"bzip2", "bz2"}) {
        const KnownVolume volume = make_volume(type, {6, 5, 7});
        const std::string text = parts_header(
            volume, encoding, order == std::endian::big ? "endian: big\n" : "endian: little\n");
        expect_bzipped(
            *directory.open("a.nrrd", to_bytes(text + "\n") + bzipped(volume.stored(order))),
            volume);
      }
}

// Several streams in one file are one, as parallel compressors write them; what follows is not.
TEST(NrrdBzip2, JoinedStreamsAndSkips) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {90, 50, 70});  // more than one block
  Bytes joined;
  for (std::size_t i = 0; i < 5; ++i)
    joined = joined + bzipped(volume.share(i, 5, std::endian::little));
  const std::string endian = "endian: little\n";
  expect_bzipped(*directory.open("a.nrrd", to_bytes(parts_header(volume, "bzip2", endian + "\n")) +
                                               joined + to_bytes("more")),
                 volume);
  write_file(directory / "a.dat",
             to_bytes("a line\n") + bzipped(to_bytes("xyz") + volume.stored()));
  for (const char* skip : {"3", "-1"})
    expect_bzipped(*directory.open("a.nhdr", parts_header(volume, "bz2",
                                                          endian + "line skip: 1\nbyte skip: " +
                                                              skip + "\ndata file: a.dat\n")),
                   volume);
}

TEST(NrrdBzip2, DamagedFiles) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {3, 4, 5});
  const Bytes head = to_bytes(parts_header(volume, "bz2", "endian: little\n\n"));
  const Bytes whole = head + bzipped(volume.stored());
  EXPECT_EQ(directory.complaint("a.nrrd", whole), "");
  directory.expect_cuts_refused("a.nrrd", whole, 1);
  std::mt19937_64 random(3);
  for (int i = 0; i < 200; ++i) {
    Bytes other = whole;
    const std::size_t at = head.size() + random() % (whole.size() - head.size() - 4);
    if (at == head.size() + 3) continue;  // the size of its blocks, which may be larger
    other[at] ^= static_cast<std::byte>(1U << random() % 8);
    EXPECT_THAT(directory.complaint("a.nrrd", other), HasSubstr("a.nrrd")) << at;
  }
  std::string large = parts_header(volume, "bz2", "endian: little\n\n");
  large.replace(large.find("3 4 5"), 5, "90000 90000 90000");
  expect_says(directory.complaint("a.nrrd", to_bytes(large) + bzipped(volume.stored())),
              {"compressed bytes hold at most"});
}

TEST(NrrdBzip2, AsTheRawFileHasIt) {
  VOXWELD_NEEDS_SHARED_DATA("nrrd/pynrrd/BallBinary30x30x30_bz2.nrrd");
  const auto packed = open_path(shared_data("nrrd/pynrrd/BallBinary30x30x30_bz2.nrrd"));
  const auto raw = open_path(shared_data("nrrd/pynrrd/BallBinary30x30x30.nrrd"));
  const Box3 all{{}, raw->info().geometry.size};
  EXPECT_EQ(read_box(*packed, all), read_box(*raw, all));
}

// Each file holds some slices where it is said to have as many dimensions as the volume.
TEST(NrrdSlabs, FilesOfSeveralSlices) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {6, 5, 12});
  for (std::size_t i = 0; i < 4; ++i)
    write_file(directory / fmt::format("s{}", i), volume.share(i, 4, std::endian::little));
  const auto header = [&](const std::string& files) {
    return parts_header(volume, "raw", "endian: little\ndata file: " + files + "\n");
  };
  expect_volume(*directory.open("a.nhdr", header("s%d 0 3 1 3")), volume);
  expect_volume(*directory.open("a.nhdr", header("LIST 3\ns0\ns1\ns2\ns3")), volume);
  expect_says(directory.complaint("a.nhdr", header("s%d 0 4 1 3")),
              {"a.nhdr:7", "5 files cannot share 12 slices"});
  expect_says(directory.complaint("a.nhdr", header("s%d 4 0 1 3")), {"0 files cannot share"});
  expect_says(directory.complaint("a.nhdr", header("s%d 0 4 0 3")), {"0 files cannot share"});
  expect_says(directory.complaint("a.nhdr", header("LIST 3")), {"0 files cannot share"});
  expect_says(directory.complaint("a.nhdr", header("LIST 4\ns0")), {"4 dimensions a file"});
}

}  // namespace
}  // namespace voxweld::testing
