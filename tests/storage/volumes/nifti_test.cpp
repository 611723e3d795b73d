#include <fmt/format.h>

#include <map>

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::map<SampleType, std::int16_t> codes = {
    {SampleType::u8, 2},    {SampleType::i8, 256}, {SampleType::u16, 512},  {SampleType::i16, 4},
    {SampleType::u32, 768}, {SampleType::i32, 8},  {SampleType::u64, 1280}, {SampleType::i64, 1024},
    {SampleType::f32, 16},  {SampleType::f64, 64}};

// A header as the test wants it, for both versions: fields by name, offsets by version.
class Header {
 public:
  Header(int version, std::endian order, const KnownVolume& volume)
      : version_(version), order_(order), bytes_(version == 1 ? 352 : 544) {
    if (version == 1) {
      put<std::int32_t>(0, 348);
      magic("n+1");
      put(108, 352.0F);
    } else {
      put<std::int32_t>(0, 540);
      magic("n+2");
      put<std::int64_t>(168, 544);
    }
    dim({3, volume.size.x, volume.size.y, volume.size.z, 1, 1, 1, 1});
    datatype(codes.at(volume.type), static_cast<std::int16_t>(8 * sample_bytes(volume.type)));
    pixdim({1, 1, 1, 1});
  }

  template <class T>
  void put(std::size_t offset, T value) {
    std::byte raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (order_ != std::endian::native) std::reverse(raw, raw + sizeof(T));
    std::copy(raw, raw + sizeof(T), bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  void real(std::size_t offset1, std::size_t offset2, const std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (version_ == 1)
        put(offset1 + 4 * i, static_cast<float>(values[i]));
      else
        put(offset2 + 8 * i, values[i]);
  }
  void magic(const std::string& text) {
    const std::string full = version_ == 1 ? text + '\0' : text + std::string("\0\r\n\x1a\n", 5);
    for (std::size_t i = 0; i < full.size(); ++i)
      bytes_[(version_ == 1 ? 344U : 4U) + i] = static_cast<std::byte>(full[i]);
  }
  void dim(const std::vector<std::int64_t>& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (version_ == 1)
        put(40 + 2 * i, static_cast<std::int16_t>(values[i]));
      else
        put(16 + 8 * i, values[i]);
  }
  void datatype(std::int16_t code, std::int16_t bits) {
    put(version_ == 1 ? 70 : 12, code);
    put(version_ == 1 ? 72 : 14, bits);
  }
  void pixdim(const std::vector<double>& values) { real(76, 104, values); }
  void scale(double slope, double inter) { real(112, 176, {slope, inter}); }
  void offset(double value) {
    if (version_ == 1)
      put(108, static_cast<float>(value));
    else
      put(168, static_cast<std::int64_t>(value));
  }
  void units(int code) {
    if (version_ == 1)
      put(123, static_cast<std::uint8_t>(code));
    else
      put<std::int32_t>(500, code);
  }
  void qform(const std::vector<double>& quatern_and_offset) {
    form(252, 344, 1);
    real(256, 352, quatern_and_offset);
  }
  void sform(const std::vector<double>& rows) {
    form(254, 348, 1);
    real(280, 400, rows);
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  void form(std::size_t offset1, std::size_t offset2, int code) {
    if (version_ == 1)
      put(offset1, static_cast<std::int16_t>(code));
    else
      put<std::int32_t>(offset2, code);
  }

  int version_;
  std::endian order_;
  Bytes bytes_;
};

TEST(Nifti, EveryTypeOrderVersionAndCompression) {
  const VolumeFolder directory;
  for (const SampleType type : all_types)
    for (const std::endian order : {std::endian::little, std::endian::big})
      for (const int version : {1, 2})
        for (const bool compressed : {false, true}) {
          const KnownVolume volume = make_volume(type, {6, 5, 7});
          Bytes data = Header(version, order, volume).bytes() + volume.stored(order);
          if (compressed) data = deflated(data, Wrapper::gzip);
          const auto source = directory.open(compressed ? "a.nii.gz" : "a.nii", data);
          expect_volume(*source, volume);
          EXPECT_EQ(source->info().format, "nifti");
          EXPECT_EQ(source->info().access, compressed ? Access::stream : Access::box);
          EXPECT_TRUE(source->info().warnings.empty());
        }
}

TEST(Nifti, PairsOfFiles) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::i16, {6, 5, 7});
  for (const int version : {1, 2}) {
    Header header(version, std::endian::big, volume);
    header.magic(version == 1 ? "ni1" : "ni2");
    header.offset(16);
    Bytes text = header.bytes();
    text.resize(text.size() - 4);
    const auto path = write_file(directory / "scan.hdr", text);
    std::filesystem::remove(directory / "scan.img.gz");
    EXPECT_THAT(complaint(path), AllOf(HasSubstr("scan.hdr"), HasSubstr(".img")));
    const Bytes data = Bytes(16) + volume.stored(std::endian::big);
    const auto image = write_file(directory / "scan.img", data);
    expect_volume(*open_path(path), volume);
    const auto source = open_path(image);
    expect_volume(*source, volume);
    EXPECT_EQ(source->info().files.size(), 2U);
    std::filesystem::remove(image);
    const auto packed = write_file(directory / "scan.img.gz", deflated(data, Wrapper::gzip));
    expect_volume(*open_path(path), volume);
    expect_volume(*open_path(packed), volume);
  }
  const auto lone = write_file(directory / "lone.img", volume.stored());
  EXPECT_THAT(complaint(InputSpec{.path = lone.string(), .format = "nifti"}),
              HasSubstr("ending in .hdr"));
}

VolumeInfo info_of(const VolumeFolder& directory, const Header& header, const KnownVolume& volume) {
  return directory.open("a.nii", header.bytes() + volume.stored())->info();
}

void expect_near(Vec3 actual, Vec3 expected) {
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(actual[axis], expected[axis], 1e-6) << axis;
}

TEST(Nifti, GeometryFromForms) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  for (const int version : {1, 2}) {
    Header header(version, std::endian::little, volume);
    header.pixdim({1, 2, 3, 0.5});
    header.units(2 + 8);
    VolumeInfo info = info_of(directory, header, volume);
    EXPECT_EQ(info.geometry.spacing, (Vec3{2, 3, 0.5}));
    EXPECT_EQ(info.geometry.unit, "mm");
    EXPECT_EQ(info.geometry.space, "");
    EXPECT_EQ(info.geometry.direction, VolumeGeometry{}.direction);

    // A quarter turn about z (x goes to y), then the third axis turned round.
    header.qform({0, 0, std::sqrt(0.5), 10, 20, 30});
    header.pixdim({-1, 2, 3, 0.5});
    info = info_of(directory, header, volume);
    EXPECT_EQ(info.geometry.spacing, (Vec3{2, 3, 0.5}));
    expect_near(info.geometry.direction[0], {0, 1, 0});
    expect_near(info.geometry.direction[1], {-1, 0, 0});
    expect_near(info.geometry.direction[2], {0, 0, -1});
    expect_near(info.geometry.origin, {10, 20, 30});
    EXPECT_EQ(info.geometry.space, "RAS");

    header.sform({-2, 0, 0, 7, 0, 3, 0, 8, 0, 0, 0.5, 9});
    info = info_of(directory, header, volume);
    expect_near(info.geometry.direction[0], {-1, 0, 0});
    expect_near(info.geometry.direction[1], {0, 1, 0});
    expect_near(info.geometry.origin, {7, 8, 9});
    EXPECT_TRUE(info.warnings.empty());

    header.pixdim({1, 2, 3, 1});
    info = info_of(directory, header, volume);
    EXPECT_NEAR(info.geometry.spacing.z, 0.5, 1e-7);
    EXPECT_THAT(info.warnings, ElementsAre(AllOf(HasSubstr("axis 2"), HasSubstr("pixdim 1"))));
  }
}

// A thousandth of a step is half a sample at the far end of 512.
TEST(Nifti, APixdimALittleOffTheSformDoesNotMoveTheFarEnd) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 2, 4});
  Header header(1, std::endian::little, volume);
  header.pixdim({1, 0.5005, 0.7, 2});
  header.sform({0.5, 0, 0, 10, 0, 0.7, 0, 20, 0, 0, 2, 30});
  const auto source = directory.open("off.nii", header.bytes() + volume.stored());
  const VolumeGeometry& geometry = source->info().geometry;
  EXPECT_EQ(geometry.spacing.x, 0.5);
  // As the float was written, which no length of a vector gives.
  EXPECT_EQ(geometry.spacing.y, static_cast<double>(0.7F));
  EXPECT_EQ(geometry.spacing.z, 2);
}

TEST(Nifti, HalfTurnsInTheQuaternion) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  Header header(1, std::endian::little, volume);
  header.qform({0, 1.0000001, 0, 0, 0, 0});
  const VolumeInfo info = info_of(directory, header, volume);
  expect_near(info.geometry.direction[0], {-1, 0, 0});
  expect_near(info.geometry.direction[1], {0, 1, 0});
  expect_near(info.geometry.direction[2], {0, 0, -1});
}

TEST(Nifti, GivesSlopeAndIntercept) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::i16, {3, 4, 5});
  for (const int version : {1, 2}) {
    Header header(version, std::endian::little, volume);
    const auto scale = [&](double slope, double inter) {
      header.scale(slope, inter);
      return info_of(directory, header, volume);
    };
    EXPECT_EQ(scale(2, -1024).scale, (ValueScale{2, -1024}));
    EXPECT_EQ(scale(-0.5, 3).scale, (ValueScale{-0.5, 3}));
    EXPECT_TRUE(scale(-0.5, 3).warnings.empty());
    for (const double slope : {0.0, std::nan(""), HUGE_VAL}) {
      EXPECT_TRUE(scale(slope, 7).scale.identity());
      EXPECT_EQ(scale(slope, 7).warnings.size(), slope == 0 ? 0U : 1U);
    }
    const VolumeInfo info = scale(2, std::nan(""));
    EXPECT_TRUE(info.scale.identity());
    EXPECT_THAT(info.warnings,
                ElementsAre(AllOf(HasSubstr("stored + nan"), HasSubstr("as stored"))));
  }
}

TEST(Nifti, WarnsOfOddFields) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::i16, {3, 4, 5});
  Header header(1, std::endian::little, volume);
  header.scale(1, 0);
  EXPECT_TRUE(info_of(directory, header, volume).warnings.empty());
  header.datatype(4, 8);
  EXPECT_THAT(info_of(directory, header, volume).warnings, ElementsAre(HasSubstr("bitpix is 8")));
  header.datatype(4, 16);
  header.pixdim({1, 0, -2, std::nan("")});
  const VolumeInfo info = info_of(directory, header, volume);
  EXPECT_EQ(info.geometry.spacing, (Vec3{1, 2, 1}));
  EXPECT_THAT(info.warnings, ElementsAre(HasSubstr("pixdim[1]: a spacing of 0 is taken as 1"),
                                         HasSubstr("pixdim[2]: a spacing of -2 is taken as 2"),
                                         HasSubstr("pixdim[3]: a spacing of nan is taken as 1")));
  header.pixdim({1, 1, 1, 1});
  header.scale(std::nan(""), 0);
  EXPECT_THAT(info_of(directory, header, volume).warnings,
              ElementsAre(HasSubstr("scaling of values by nan * stored + 0 is not finite")));
  header.scale(0, 0);
  EXPECT_TRUE(info_of(directory, header, volume).warnings.empty());
  header.offset(0);
  EXPECT_THAT(info_of(directory, header, volume).warnings,
              ElementsAre(HasSubstr("vox_offset is 0")));
}

TEST(Nifti, ExtensionsBeforeTheSamples) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::u8, {3, 4, 5});
  for (const int version : {1, 2}) {
    Header header(version, std::endian::little, volume);
    header.offset(static_cast<double>(header.bytes().size()) + 64);
    expect_volume(
        *directory.open("a.nii", header.bytes() + Bytes(64, std::byte{7}) + volume.stored()),
        volume);
  }
}

TEST(Nifti, BadHeadersAreNamed) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::i16, {3, 4, 5});
  const auto say = [&](const std::function<void(Header&)>& change) {
    Header header(1, std::endian::little, volume);
    change(header);
    return directory.complaint("a.nii", header.bytes() + volume.stored());
  };
  const auto refused = [&](const std::function<void(Header&)>& change,
                           std::initializer_list<std::string> parts) {
    expect_says(say(change), parts);
  };
  EXPECT_EQ(say([](Header&) {}), "");
  refused([](Header& h) { h.dim({4, 3, 4, 5, 12}); }, {"a.nii", "12 volumes"});
  EXPECT_EQ(say([](Header& h) { h.dim({5, 3, 4, 5, 1, 1}); }), "");
  refused([](Header& h) { h.dim({2, 3, 4}); }, {"found 2"});
  refused([](Header& h) { h.dim({3, 3, -4, 5}); }, {"sizes must be positive"});
  refused([](Header& h) { h.dim({3, 3, 4, 6}); }, {"truncated", "144 bytes"});
  refused([](Header& h) { h.datatype(128, 24); }, {"128 (RGB colour)"});
  refused([](Header& h) { h.datatype(32, 64); }, {"32 (complex64)"});
  refused([](Header& h) { h.datatype(77, 64); }, {"77 (unknown)"});
  refused([](Header& h) { h.offset(100); }, {"vox_offset"});
  refused([](Header& h) { h.offset(352.5); }, {"found 352.5"});
  refused([](Header& h) { h.offset(std::nan("")); }, {"found nan"});
  refused(
      [](Header& h) {
        h.sform({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0});
      },
      {"sform: the step along axis 2"});
  refused([](Header& h) { h.magic("xyz"); }, {"not a NIfTI header"});
  refused(
      [](Header& h) {
        h.magic(std::string(3, '\0'));
        h.put<std::uint8_t>(38, 'r');
      },
      {"Analyze 7.5"});
}

TEST(Nifti, TruncatedFilesAreRefused) {
  const VolumeFolder directory;
  const KnownVolume volume = make_volume(SampleType::i16, {6, 5, 7});
  for (const int version : {1, 2}) {
    const Bytes whole = Header(version, std::endian::little, volume).bytes() + volume.stored();
    directory.expect_cuts_refused("a.nii", whole, 13);
    directory.expect_cuts_refused("a.nii.gz", deflated(whole, Wrapper::gzip), 7);
  }
}

}  // namespace
}  // namespace voxweld::testing
