// Whatever a header says, opening and reading it ends in a volume or in one clear error.
#include <fmt/format.h>

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {
namespace {

// Replaces, drops or doubles a few bytes of the first `limit`.
Bytes damaged(Bytes data, std::size_t limit, std::mt19937_64& random) {
  for (std::uint64_t changes = 1 + random() % 4; changes > 0; --changes) {
    const auto at =
        data.begin() + static_cast<std::ptrdiff_t>(random() % std::min(limit, data.size()));
    switch (random() % 4) {
      case 0:
        *at = static_cast<std::byte>(random());
        break;
      case 1:
        *at = static_cast<std::byte>("0123456789-. \n,()%"[random() % 18]);
        break;
      case 2:
        data.erase(at);
        break;
      default:
        data.insert(at, *at);
    }
  }
  return data;
}

void expect_no_surprise(const Bytes& whole, std::size_t header_bytes, const std::string& name) {
  const TempDirectory directory;
  std::mt19937_64 random(3);
  const std::string format = name.ends_with("nrrd")  ? "nrrd"
                             : name.ends_with("mha") ? "metaimage"
                             : name.ends_with("inr") ? "inrimage"
                                                     : "nifti";
  int refused = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto path = write_file(directory / name, damaged(whole, header_bytes, random));
    const std::string said = complaint(InputSpec{.path = path.string(), .format = format});
    if (said.empty()) continue;
    ++refused;
    ASSERT_NE(said.find(name), std::string::npos) << said;
    ASSERT_LT(said.size(), 600U) << said;
  }
  EXPECT_GT(refused, 50);
}

TEST(DamagedHeaders, Nrrd) {
  const KnownVolume volume = make_volume(SampleType::i16, {3, 4, 5});
  for (const char* encoding : {"raw", "gzip", "ascii"}) {
    const Bytes head = to_bytes(fmt::format(
        "NRRD0005\ntype: short\ndimension: 4\nsizes: 1 3 4 5\nendian: little\nencoding: {}\nkinds: "
        "vector space space space\nspace: LPS\nspace directions: none (1,0,0) (0,1,0) "
        "(0,0,1)\nspace "
        "origin: (1,2,3)\nbyte skip: 0\nspace units: \"mm\" \"mm\" \"mm\"\n\n",
        encoding));
    const Bytes data = encoding[0] == 'r'   ? volume.stored()
                       : encoding[0] == 'g' ? deflated(volume.stored(), Wrapper::gzip)
                                            : to_bytes(as_text(volume));
    expect_no_surprise(head + data, head.size() + 20, "a.nrrd");
  }
}

TEST(DamagedHeaders, Inrimage) {
  const KnownVolume volume = make_volume(SampleType::i16, {3, 4, 5});
  std::string head =
      "#INRIMAGE-4#{\nXDIM=3\nYDIM=4\nZDIM=5\nVDIM=1\nTYPE=signed fixed\nPIXSIZE=16 "
      "bits\nSCALE=2**0\nCPU=sun\nVX=1\nVY=2\nVZ=0.5\nTX=7\n";
  head.append(252 - head.size(), '\n');
  expect_no_surprise(to_bytes(head + "##}\n") + volume.stored(), 140, "a.inr");
}

TEST(DamagedHeaders, MetaImage) {
  const KnownVolume volume = make_volume(SampleType::i16, {3, 4, 5});
  for (const char* compressed : {"True", "False"}) {
    const Bytes head = to_bytes(fmt::format(
        "NDims = 3\nDimSize = 3 4 5\nCompressedData = {}\nElementType = MET_SHORT\nOffset = 1 2 "
        "3\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nElementSpacing = 1 1 2\nHeaderSize = "
        "0\nElementDataFile = LOCAL\n",
        compressed));
    const Bytes data =
        compressed[0] == 'T' ? deflated(volume.stored(), Wrapper::zlib) : volume.stored();
    expect_no_surprise(head + data, head.size() + 20, "a.mha");
  }
}

TEST(DamagedHeaders, Nifti) {
  Bytes first(352 + 120), second(544 + 120);
  const auto put = [](Bytes& bytes, std::size_t at, auto value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
  };
  put(first, 0, std::int32_t{348});
  std::memcpy(first.data() + 344, "n+1", 4);
  put(second, 0, std::int32_t{540});
  std::memcpy(second.data() + 4, "n+2\0\r\n\x1a\n", 8);
  const std::int64_t dim[4] = {3, 3, 4, 5};
  for (std::size_t i = 0; i < 4; ++i) {
    put(first, 40 + 2 * i, static_cast<std::int16_t>(dim[i]));
    put(second, 16 + 8 * i, dim[i]);
    put(first, 76 + 4 * i, 1.0F);
    put(second, 104 + 8 * i, 1.0);
  }
  put(first, 70, std::int16_t{4});
  put(second, 12, std::int16_t{4});
  put(first, 72, std::int16_t{16});
  put(second, 14, std::int16_t{16});
  put(first, 108, 352.0F);
  put(second, 168, std::int64_t{544});
  put(first, 252, std::int16_t{1});
  put(second, 344, std::int32_t{1});
  expect_no_surprise(first, 352, "a.nii");
  expect_no_surprise(second, 544, "a.nii");
  const Bytes packed = deflated(first, Wrapper::gzip);
  expect_no_surprise(packed, packed.size(), "a.nii.gz");
}

}  // namespace
}  // namespace voxweld::testing
