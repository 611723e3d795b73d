#include <fmt/format.h>

#include <atomic>
#include <thread>

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

InputSpec raw_spec(const std::filesystem::path& path, const KnownVolume& volume) {
  InputSpec spec{.path = path.string(), .format = "raw"};
  spec.raw.size = volume.size;
  spec.raw.type = volume.type;
  return spec;
}

TEST(Raw, EveryTypeAndByteOrder) {
  const TempDirectory directory;
  for (const SampleType type : all_types)
    for (const std::endian order : {std::endian::little, std::endian::big}) {
      const KnownVolume volume = make_volume(type, {11, 7, 5});
      InputSpec spec = raw_spec(write_file(directory / "a.raw", volume.stored(order)), volume);
      spec.raw.byte_order = order;
      const auto source = open_volume(spec);
      expect_volume(*source, volume);
      EXPECT_EQ(source->info().format, "raw");
      EXPECT_TRUE(source->info().warnings.empty());
    }
}

TEST(Raw, SkipsTheHeaderOrTakesTheEnd) {
  const TempDirectory directory;
  const KnownVolume volume = make_volume(SampleType::i16, {5, 4, 3});
  InputSpec spec =
      raw_spec(write_file(directory / "a.dat", Bytes(21, std::byte{9}) + volume.stored()), volume);
  spec.raw.header_bytes = 21;
  expect_volume(*open_volume(spec), volume);
  spec.raw.header_bytes = -1;
  expect_volume(*open_volume(spec), volume);
  // Less is not wrong, but to be told.
  spec.raw.header_bytes = 20;
  EXPECT_THAT(open_volume(spec)->info().warnings,
              ::testing::ElementsAre(AllOf(HasSubstr("a.dat"), HasSubstr("1 bytes after"))));
}

// Rows longer and shorter than the batching limits, with gaps on either side of them.
TEST(Raw, BoxesOfWideVolumes) {
  const TempDirectory directory;
  for (const Index3 size : {Index3{5000, 40, 3}, {40000, 9, 2}, {600000, 3, 2}, {300, 700, 3}}) {
    const KnownVolume volume = make_volume(SampleType::u16, size);
    InputSpec spec =
        raw_spec(write_file(directory / "a.raw", volume.stored(std::endian::big)), volume);
    spec.raw.byte_order = std::endian::big;
    const auto source = open_volume(spec);
    expect_volume(*source, volume);
    for (const std::int64_t gap : {1, 100, 3000, 4096, 4097}) {
      if (gap >= size.x) continue;
      const Box3 box{{gap / 2, 1, 0}, {size.x - (gap + 1) / 2, size.y, 2}};
      ASSERT_EQ(read_box(*source, box), volume.box(box));
    }
  }
}

void expect_threads_agree(const SampleSource& source, const KnownVolume& volume) {
  std::atomic<int> wrong = 0;
  std::vector<std::jthread> threads;
  for (unsigned t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      std::mt19937_64 random(t);
      for (int i = 0; i < 200; ++i) {
        const Box3 box = random_box(volume.size, random);
        if (read_box(source, box) != volume.box(box)) ++wrong;
      }
    });
  threads.clear();
  EXPECT_EQ(wrong, 0);
}

TEST(Raw, ManyThreadsReadAtOnce) {
  const TempDirectory directory;
  const KnownVolume volume = make_volume(SampleType::f32, {40, 30, 20});
  expect_threads_agree(
      *open_volume(raw_spec(write_file(directory / "a.raw", volume.stored()), volume)), volume);
}

// More files than are kept open at once.
TEST(Raw, ManyThreadsReadManyFiles) {
  const TempDirectory directory;
  const KnownVolume volume = make_volume(SampleType::u8, {8, 6, 150});
  for (std::size_t z = 0; z < 150; ++z)
    write_file(directory / fmt::format("s{}", z), volume.share(z, 150, std::endian::little));
  const auto path = write_file(directory / "a.mhd",
                               std::string("NDims = 3\nDimSize = 8 6 150\nElementType = MET_UCHAR\n"
                                           "ElementDataFile = s%d 0 149 1\n"));
  expect_threads_agree(*open_path(path), volume);
}

TEST(Raw, RefusesEveryTruncation) {
  const TempDirectory directory;
  const KnownVolume volume = make_volume(SampleType::u16, {4, 3, 2});
  const Bytes whole = volume.stored();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto path = write_file(directory / "a.raw", std::span(whole).first(size));
    EXPECT_THAT(complaint(raw_spec(path, volume)),
                AllOf(HasSubstr("a.raw: truncated"), HasSubstr("48 in all"),
                      HasSubstr("the file has " + std::to_string(size))));
  }
}

TEST(Raw, NamesWhatIsWrong) {
  const TempDirectory directory;
  const KnownVolume volume = make_volume(SampleType::u8, {4, 3, 2});
  const auto path = write_file(directory / "a.raw", volume.stored());
  InputSpec spec{.path = path.string()};
  EXPECT_THAT(complaint(spec), AllOf(HasSubstr("a.raw"), HasSubstr("size and type")));
  spec.raw.size = volume.size;
  EXPECT_THAT(complaint(spec), HasSubstr("give the type"));
  spec = raw_spec(path, volume);
  spec.raw.header_bytes = -2;
  EXPECT_THAT(complaint(spec), HasSubstr("found -2"));
  spec = raw_spec(path, volume);
  spec.raw.size = Index3{4, 0, 2};
  EXPECT_THAT(complaint(spec), HasSubstr("found 4 0 2"));
  const std::int64_t big = std::int64_t{1} << 40;
  spec.raw.size = Index3{big, big, big};
  EXPECT_THAT(complaint(spec), HasSubstr("more than any file holds"));
  spec = raw_spec(directory / "none.raw", volume);
  EXPECT_THAT(complaint(spec), HasSubstr("none.raw: no such file"));
  spec = raw_spec(directory.path(), volume);
  EXPECT_THAT(complaint(spec), HasSubstr("not a regular file"));
}

TEST(Raw, ReadingOutsideIsABug) {
  const TempDirectory directory;
  const KnownVolume volume = make_volume(SampleType::u8, {4, 3, 2});
  const auto source =
      open_volume(raw_spec(write_file(directory / "a.raw", volume.stored()), volume));
  std::byte out[64];
  EXPECT_THROW(source->read({{0, 0, 0}, {5, 1, 1}}, out), std::logic_error);
  EXPECT_THROW(source->read({{-1, 0, 0}, {1, 1, 1}}, out), std::logic_error);
  EXPECT_THROW(source->read({{1, 1, 1}, {1, 2, 2}}, out), std::logic_error);
}

TEST(Raw, TheSpecSetsGeometry) {
  const TempDirectory directory;
  const KnownVolume volume = make_volume(SampleType::u8, {4, 3, 2});
  InputSpec spec = raw_spec(write_file(directory / "a.raw", volume.stored()), volume);
  spec.spacing = Vec3{1, 2, 3};
  spec.unit = "micrometers";
  const VolumeInfo info = open_volume(spec)->info();
  EXPECT_EQ(info.geometry.spacing, (Vec3{1, 2, 3}));
  EXPECT_EQ(info.geometry.unit, "um");
  ASSERT_EQ(info.files.size(), 1U);
  EXPECT_EQ(info.files[0].state.size, 24U);
  EXPECT_NE(info.files[0].state.mtime_ns, 0);
  spec.spacing->y = 0;
  EXPECT_THROW(open_volume(spec), InputError);
}

}  // namespace
}  // namespace voxweld::testing
