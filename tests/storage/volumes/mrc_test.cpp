#include <fmt/format.h>

#include <cmath>

#include "storage/support/byte_order.h"

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Words of the header by their numbers, from 1, over a plain one.
class MrcFile {
 public:
  MrcFile(const KnownVolume& volume, std::endian order = std::endian::little)
      : volume_(volume), order_(order), head_(1024) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto side = static_cast<std::int32_t>(volume.size[static_cast<int>(i)]);
      set(1 + i, side);
      set(8 + i, side);
      set(17 + i, static_cast<std::int32_t>(i) + 1);
      set(14 + i, 90.0F);
    }
    const Vec3 spacing{1, 2, 0.5};
    for (int i = 0; i < 3; ++i)
      set(11 + static_cast<std::size_t>(i),
          static_cast<float>(spacing[i] * static_cast<double>(volume.size[i])));
    set(4, volume.type == SampleType::i16   ? 1
           : volume.type == SampleType::f32 ? 2
           : volume.type == SampleType::u16 ? 6
                                            : 0);
    set(23, 1);
    set(28, 20140);
    std::memcpy(head_.data() + 208, "MAP ", 4);
    const auto stamp = order == std::endian::little ? std::byte{0x44} : std::byte{0x11};
    head_[212] = head_[213] = stamp;
  }

  template <class T>
  MrcFile& set(std::size_t word, T value) {
    static_assert(sizeof(T) == 4);
    std::byte* at = head_.data() + 4 * (word - 1);
    std::memcpy(at, &value, 4);
    to_native(at, 1, 4, order_);
    return *this;
  }
  MrcFile& bytes(std::size_t at, const std::string& text) {
    std::memcpy(head_.data() + at, text.data(), text.size());
    return *this;
  }
  MrcFile& extended(std::size_t count) {
    extended_ = Bytes(count, std::byte{7});
    return set(24, static_cast<std::int32_t>(count));
  }
  Bytes whole() const { return head_ + extended_ + volume_.stored(order_); }

 private:
  KnownVolume volume_;
  std::endian order_;
  Bytes head_, extended_;
};

constexpr SampleType mrc_types[] = {SampleType::i8, SampleType::i16, SampleType::u16,
                                    SampleType::f32};

TEST(Mrc, EveryTypeOrderAndCompression) {
  const VolumeFolder directory;
  for (const SampleType type : mrc_types)
    for (const std::endian order : {std::endian::little, std::endian::big})
      for (const bool compressed : {false, true})
        for (const std::size_t extended : {0, 80, 5000}) {
          const KnownVolume volume = make_volume(type, {6, 5, 7});
          Bytes data = MrcFile(volume, order).extended(extended).whole();
          if (compressed) data = deflated(data, Wrapper::gzip);
          for (const std::string name : {"a.mrc", "a.dat"}) {
            const auto source = directory.open(compressed ? name + ".gz" : name, data);
            expect_volume(*source, volume);
            const VolumeInfo& info = source->info();
            EXPECT_EQ(info.format, "mrc");
            EXPECT_EQ(info.access, compressed ? Access::stream : Access::box);
            EXPECT_EQ(info.geometry.spacing, (Vec3{1, 2, 0.5}));
            EXPECT_EQ(info.geometry.origin, (Vec3{0, 0, 0}));
            EXPECT_EQ(info.geometry.unit, "angstrom");
            EXPECT_EQ(info.warnings.size(), 0U);
            EXPECT_EQ(info.files.size(), 1U);
          }
        }
}

// The samples with axis i of the file as axis along[i].
KnownVolume turned(const KnownVolume& file, const std::array<int, 3>& along) {
  KnownVolume volume = file;
  for (int i = 0; i < 3; ++i) volume.size[along[static_cast<std::size_t>(i)]] = file.size[i];
  const std::size_t width = sample_bytes(file.type);
  std::size_t from = 0;
  each_index(file.size, [&](Index3 at) {
    Index3 to;
    for (int i = 0; i < 3; ++i) to[along[static_cast<std::size_t>(i)]] = at[i];
    const std::int64_t place = (to.z * volume.size.y + to.y) * volume.size.x + to.x;
    std::memcpy(volume.samples.data() + static_cast<std::size_t>(place) * width,
                file.samples.data() + from, width);
    from += width;
  });
  return volume;
}

// Sizes larger than what is read at once, along each axis.
TEST(Mrc, AxesInEveryOrder) {
  const VolumeFolder directory;
  for (const auto& along : {std::array{0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}})
    for (const SampleType type : mrc_types) {
      const KnownVolume file = make_volume(type, {270, 37, 19});
      MrcFile mrc(file, std::endian::big);
      for (std::size_t i = 0; i < 3; ++i) {
        mrc.set(17 + i, static_cast<std::int32_t>(along[i]) + 1);
        mrc.set(8 + i, 10);  // of X, Y and Z whatever the order
        mrc.set(5 + i, static_cast<std::int32_t>(i) + 1);
        mrc.set(11 + i, 10 * static_cast<float>(i + 1));
      }
      const auto source = directory.open("a.map", mrc.whole());
      expect_volume(*source, turned(file, along));
      EXPECT_EQ(source->info().access, Access::box);
      EXPECT_EQ(source->info().geometry.spacing, (Vec3{1, 2, 3}));
      Vec3 origin;
      for (std::size_t i = 0; i < 3; ++i)
        origin[along[i]] = static_cast<double>((i + 1) * (static_cast<std::size_t>(along[i]) + 1));
      EXPECT_EQ(source->info().geometry.origin, origin);
      expect_says(directory.complaint("a.map.gz", deflated(mrc.whole(), Wrapper::gzip)),
                  {"byte 64", "decompress it with gunzip"});
    }
}

TEST(Mrc, BytesAreSignedOrNot) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::i8, {3, 4, 5});
  const auto info = [&](const MrcFile& file) {
    return directory.open("a.mrc", file.whole())->info();
  };
  const auto old = [&] { return MrcFile(volume).set(28, 0); };
  EXPECT_EQ(info(MrcFile(volume)).type, SampleType::i8);
  EXPECT_EQ(info(MrcFile(volume).set(39, 1146047817)).type, SampleType::u8);
  EXPECT_EQ(info(MrcFile(volume).set(39, 1146047817).set(40, 1)).type, SampleType::i8);
  EXPECT_EQ(info(old().set(20, -1.0F).set(21, 100.0F)).type, SampleType::i8);
  EXPECT_EQ(info(old().set(20, 0.0F).set(21, 200.0F)).type, SampleType::u8);
  EXPECT_EQ(info(old().set(20, 0.0F).set(21, 100.0F)).type, SampleType::i8);
  EXPECT_EQ(info(old()).type, SampleType::i8);
  EXPECT_THAT(info(old()).warnings, ElementsAre(HasSubstr("whether its bytes are signed")));
}

TEST(Mrc, Geometry) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::f32, {4, 4, 4});
  const auto info = [&](const MrcFile& file) {
    return directory.open("a.mrc", file.whole())->info();
  };
  const MrcFile plain(volume);
  EXPECT_EQ(info(MrcFile(volume).set(50, 1.5F).set(52, -2.0F)).geometry.origin, (Vec3{1.5, 0, -2}));
  EXPECT_EQ(info(MrcFile(volume).set(5, 10).set(6, -3)).geometry.origin, (Vec3{10, -6, 0}));
  const VolumeInfo both = info(MrcFile(volume).set(5, 10).set(50, 11.0F));
  EXPECT_EQ(both.geometry.origin, (Vec3{11, 0, 0}));
  EXPECT_THAT(both.warnings, ElementsAre(HasSubstr("the former is taken")));
  EXPECT_EQ(info(MrcFile(volume).set(5, 10).set(50, 10.0F)).warnings.size(), 0U);
  const VolumeInfo none = info(MrcFile(volume).set(11, 0.0F).set(9, 0).set(50, NAN));
  EXPECT_EQ(none.geometry.spacing, (Vec3{1, 1, 0.5}));
  EXPECT_THAT(none.warnings, ElementsAre(HasSubstr("cell along X"), HasSubstr("cell along Y"),
                                         HasSubstr("byte 196")));
  // Monoclinic: the third axis leans toward the first.
  const VolumeInfo skew = info(MrcFile(volume).set(15, 120.0F));
  EXPECT_NEAR(skew.geometry.direction[2].x, -0.5, 1e-12);
  EXPECT_NEAR(skew.geometry.direction[2].y, 0, 1e-12);
  EXPECT_NEAR(skew.geometry.direction[2].z, std::sqrt(0.75), 1e-12);
  EXPECT_EQ(skew.geometry.spacing, (Vec3{1, 2, 0.5}));
  EXPECT_THAT(skew.warnings, ElementsAre(HasSubstr("not perpendicular")));
}

TEST(Mrc, OldFiles) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::i16, {6, 5, 7});
  const std::string nothing(4, '\0');
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    MrcFile file(volume, order);
    file.bytes(208, nothing).bytes(212, nothing).set(28, 0);
    for (std::size_t i = 17; i < 20; ++i) file.set(i, 0);
    const auto source = directory.open("a.rec", file.whole());
    expect_volume(*source, volume);
    EXPECT_THAT(source->info().warnings,
                ElementsAre(HasSubstr("no MAP at byte 208"), HasSubstr("no machine stamp")));
    EXPECT_THAT(directory.complaint("a.xyz", file.whole()), HasSubstr("unknown kind"));
    // A stamp of the other order.
    MrcFile wrong(volume, order);
    wrong.bytes(212, order == std::endian::little ? "\x11\x11" : "DD");
    expect_volume(*directory.open("b.mrc", wrong.whole()), volume);
  }
}

TEST(Mrc, WhatCannotBeReadIsNamed) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {3, 4, 5});
  const auto say = [&](std::size_t word, auto value) {
    return directory.complaint("a.mrc", MrcFile(volume).set(word, value).whole());
  };
  EXPECT_EQ(say(1, 3), "");
  for (const std::int32_t mode : {3, 4, 5, 12, 16, 101})
    expect_says(say(4, mode), {"a.mrc: byte 12", fmt::format("mode {} (", mode)});
  expect_says(say(4, 99), {"no sense in either byte order"});
  expect_says(say(1, 0), {"no sense"});
  expect_says(say(2, -4), {"no sense"});
  expect_says(say(17, 2), {"no sense"});
  expect_says(say(24, -1), {"no sense"});
  expect_says(say(24, 1000000), {"truncated"});
  expect_says(say(3, 6), {"truncated"});
  expect_says(say(3, 0x7fffffff), {"truncated"});
  expect_says(say(23, 401), {"byte 88", "a stack of volumes"});
  expect_says(say(14, -3.0F), {"byte 52", "an angle of -3"});
  expect_says(say(11, std::numeric_limits<float>::infinity()), {""});
  EXPECT_THAT(
      directory.open("a.st", MrcFile(volume).set(23, 0).set(10, 1).whole())->info().warnings,
      ElementsAre(HasSubstr("a stack of images")));
}

TEST(Mrc, DamagedFiles) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u16, {3, 4, 5});
  const Bytes whole = MrcFile(volume).extended(16).whole();
  EXPECT_EQ(directory.complaint("a.mrc", whole), "");
  directory.expect_cuts_refused("a.mrc", whole, 7);
  const Bytes packed = deflated(whole, Wrapper::gzip);
  directory.expect_cuts_refused("a.mrc.gz", packed, 3);
  std::mt19937_64 random(3);
  for (int i = 0; i < 1000; ++i) {
    Bytes other = whole;
    other[random() % 256] ^= static_cast<std::byte>(1U << random() % 8);
    directory.complaint("a.mrc", other);  // an error or none, but no crash
  }
}

}  // namespace
}  // namespace voxweld::testing
