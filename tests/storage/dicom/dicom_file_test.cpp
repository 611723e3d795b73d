// Single files: samples in every form, damage, what is told from what.
#include "tests/storage/dicom/dicom_folder.h"

namespace voxweld::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::uint32_t pixels = 0x7fe00010;

std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// A file of frames without positions, of samples of `stored` bits whose highest is `high`.
struct Layout {
  SampleType type = SampleType::i16;
  int stored = 16, high = 15;
};
DicomFile frames_of(const KnownVolume& volume, const Layout& layout, const std::string& data) {
  const Index3 n = volume.size;
  const bool is_signed = layout.type == SampleType::i8 || layout.type == SampleType::i16 ||
                         layout.type == SampleType::i32;
  DicomFile file = ct_slice({.columns = static_cast<int>(n.x), .rows = static_cast<int>(n.y)});
  file.text(0x00280008, "IS", std::to_string(n.z))
      .text(0x00180088, "DS", "1.5")
      .u16(0x00280100, static_cast<unsigned>(8 * sample_bytes(layout.type)))
      .u16(0x00280101, static_cast<unsigned>(layout.stored))
      .u16(0x00280102, static_cast<unsigned>(layout.high))
      .u16(0x00280103, is_signed ? 1 : 0)
      .raw(pixels, sample_bytes(layout.type) == 1 ? "OB" : "OW", data);
  return file;
}

TEST(DicomFiles, EveryTypeAndForm) {
  const VolumeFolder folder;
  for (const SampleType type : {SampleType::u8, SampleType::i8, SampleType::u16, SampleType::i16,
                                SampleType::u32, SampleType::i32})
    for (const DicomForm& form : {explicit_little, implicit_little, explicit_big}) {
      const KnownVolume volume = make_volume(type, {6, 5, 4});
      const int bits = static_cast<int>(8 * sample_bytes(type));
      const DicomFile file =
          frames_of(volume, {type, bits, bits - 1}, text_of(volume.stored(form.order)));
      const auto source = folder.open("a", to_bytes(file.bytes(form)));
      expect_slices(*source, volume);
      EXPECT_EQ(source->info().geometry.spacing, (Vec3{0.5, 0.5, 1.5}));
      expect_says(warnings_of(*source), {"1.5 is taken, as (0018,0088) SpacingBetweenSlices says"});
    }
}

TEST(DicomFiles, BitsThatHoldOtherThingsAreCutOff) {
  const VolumeFolder folder;
  std::mt19937 random(3);
  for (const bool is_signed : {false, true})
    for (const int high : {11, 13}) {
      KnownVolume volume{is_signed ? SampleType::i16 : SampleType::u16, {6, 5, 2}, {}};
      std::string data;
      for (int i = 0; i < 60; ++i) {
        const auto word = static_cast<std::uint16_t>(random());
        data += static_cast<char>(word & 0xff);
        data += static_cast<char>(word >> 8);
        int value = word >> (high - 11) & 0xfff;
        if (is_signed && value >= 2048) value -= 4096;
        const auto sample = static_cast<std::uint16_t>(value);
        const auto bytes = std::as_bytes(std::span(&sample, 1));
        volume.samples.insert(volume.samples.end(), bytes.begin(), bytes.end());
      }
      const DicomFile file = frames_of(volume, {volume.type, 12, high}, data);
      expect_slices(*folder.open("a", to_bytes(file.bytes())), volume);
    }
}

TEST(DicomFiles, WithoutPreambleOrWithTheWrongSyntax) {
  const VolumeFolder folder;
  const KnownVolume volume = make_volume(SampleType::i16, {6, 5, 4});
  const DicomFile file = frames_of(volume, {}, text_of(volume.stored()));
  for (const DicomForm& form : {explicit_little, implicit_little})
    expect_slices(*folder.open("a", to_bytes(file.bytes(form, false))), volume);
  DicomForm wrong = implicit_little;
  wrong.explicit_vr = true;
  const auto source = folder.open("a", to_bytes(file.bytes(wrong)));
  expect_slices(*source, volume);
  expect_says(warnings_of(*source), {"its transfer syntax is 1.2.840.10008.1.2 (implicit"});
}

TEST(DicomFiles, WhatIsTakenForDicom) {
  const VolumeFolder folder;
  const auto format_said = [&](const std::string& name, const std::string& bytes) {
    return folder.complaint(name, to_bytes(bytes));
  };
  EXPECT_THAT(format_said("text", "A text that is no volume, long enough for a header of any kind"),
              HasSubstr("unknown kind"));
  EXPECT_THAT(format_said("two", std::string("\x08\0\0\0\x04\0\0\0\1\0\0\0", 12)),
              HasSubstr("unknown kind"));
  EXPECT_THAT(format_said("a.dcm", "not at all"), HasSubstr("a.dcm"));
  // One folder of images, one with DICOM a level down.
  std::filesystem::create_directories(folder / "tree/inner");
  EXPECT_THAT(complaint(folder / "tree"), HasSubstr("no images"));
  const KnownVolume volume = make_volume(SampleType::i16, {6, 5, 4});
  write_file(folder / "tree/inner/I1", frames_of(volume, {}, text_of(volume.stored())).bytes());
  expect_slices(*open_path(folder / "tree"), volume);
}

TEST(DicomFiles, AMissingModuleIsToldByItsLibrary) {
  const VolumeFolder folder;
  std::vector<VolumeReader> readers;
  for (const VolumeReader& reader : volume_readers())
    if (reader.name == "dicom") readers.push_back(reader);
  ASSERT_EQ(readers.size(), 1U);
  readers.front().module = "nowhere";
  const auto path = write_file(folder / "a", std::string(128, '\0') + "DICM and more");
  try {
    open_volume({.path = path.string()}, readers);
    FAIL();
  } catch (const InputError& error) {
    expect_says(error.what(), {"libvoxweld_nowhere.so", "built where GDCM (Debian: libgdcm-dev)"});
  }
}

TEST(DicomFiles, WhatIsNotReadIsRefusedByName) {
  const VolumeFolder folder;
  const KnownVolume volume = make_volume(SampleType::i16, {6, 5, 4});
  const DicomFile whole = frames_of(volume, {}, text_of(volume.stored()));
  const auto said = [&](const DicomFile& file, const DicomForm& form = explicit_little) {
    return folder.complaint("a", to_bytes(file.bytes(form)));
  };
  DicomForm mpeg;
  mpeg.syntax = "1.2.840.10008.1.2.4.102";
  expect_says(said(whole, mpeg), {"1.2.840.10008.1.2.4.102 (MPEG-4", "gdcmconv --raw"});
  mpeg.syntax = "1.2.3.4";
  expect_says(said(whole, mpeg), {"1.2.3.4 (private or unknown)"});
  DicomFile file = whole;
  expect_says(said(file.text(0x00280004, "CS", "PALETTE COLOR")), {"colours (PALETTE COLOR"});
  file = whole;
  expect_says(said(file.u16(0x00280100, 12)), {"samples take 12 bits"});
  file = whole;
  expect_says(said(file.u16(0x00280102, 16)), {"up to bit 16"});
  file = whole;
  file.drop(pixels).raw(0x7fe00008, "OW", std::string(480, '\0')).u16(0x00280100, 32);
  expect_says(said(file), {"(7fe0,0008) FloatPixelData"});
  file = whole;
  expect_says(said(file.drop(pixels)), {"has no (7fe0,0010) PixelData"});
  file = whole;
  expect_says(said(file.text(0x00200037, "DS", "1\\0\\0\\1\\0\\0")), {"no perpendicular unit"});
  file = whole;
  expect_says(said(file.text(0x00200032, "DS", "1\\2")),
              {"(0020,0032) ImagePositionPatient: expected 3 numbers, found '1\\2'"});
}

TEST(DicomFiles, AbsurdSizesAreRefused) {
  const VolumeFolder folder;
  const KnownVolume volume = make_volume(SampleType::i16, {6, 5, 4});
  const DicomFile whole = frames_of(volume, {}, text_of(volume.stored()));
  const auto said = [&](const DicomFile& file) {
    return folder.complaint("a", to_bytes(file.bytes()));
  };
  DicomFile file = whole;
  expect_says(said(file.u16(0x00280010, 65535).u16(0x00280011, 65535)), {"take 34358689800 bytes"});
  file = whole;
  expect_says(said(file.u16(0x00280010, 0)), {"its size is 6 x 0"});
  file = whole;
  expect_says(said(file.text(0x00280008, "IS", "2000000000")), {"at most 65536"});
  expect_says(said(file.text(0x00280008, "IS", "5")), {"in 5 frames take 300 bytes"});
  expect_says(said(file.text(0x00280008, "IS", "-1")), {"NumberOfFrames is -1"});
  // A compressed frame of a few bytes.
  file.u16(0x00280010, 65535).u16(0x00280011, 65535).text(0x00280008, "IS", "1");
  file.fragments({"\xff\xd8\xff\xd9"});
  DicomForm jpeg;
  jpeg.syntax = "1.2.840.10008.1.2.4.70";
  const auto path = write_file(folder / "a", file.bytes(jpeg));
  const auto source = open_path(path);
  std::vector<std::byte> row(65535 * 2);
  try {
    source->read({{}, {65535, 1, 1}}, row.data());
    FAIL();
  } catch (const FormatError& error) {
    expect_says(error.what(), {"cannot come from 4 compressed ones"});
  }
}

// Nothing is read wrongly: what opens has the whole file's facts.
TEST(DicomFiles, CutShortAnywhere) {
  const VolumeFolder folder;
  const KnownVolume volume = make_volume(SampleType::i16, {6, 5, 4});
  for (const DicomForm& form : {explicit_little, implicit_little, explicit_big}) {
    const Bytes whole =
        to_bytes(frames_of(volume, {}, text_of(volume.stored(form.order))).bytes(form));
    folder.expect_cuts_refused("a.dcm", whole, 1);
  }
}

TEST(DicomFiles, FlippedBytesAreErrorsOrOtherValues) {
  const VolumeFolder folder;
  const KnownVolume volume = make_volume(SampleType::i16, {6, 5, 4});
  const Bytes whole = to_bytes(frames_of(volume, {}, text_of(volume.stored())).bytes());
  std::mt19937 random(11);
  std::size_t refused = 0;
  for (int i = 0; i < 3000; ++i) {
    Bytes bytes = whole;
    for (auto flips = 1 + random() % 3; flips > 0; --flips)
      bytes[132 + random() % (bytes.size() - 132)] = static_cast<std::byte>(random());
    if (!folder.complaint("a.dcm", bytes).empty()) ++refused;
  }
  EXPECT_GT(refused, 300U);
}

TEST(DicomFiles, ADicomdirNamesTheFiles) {
  const DicomFolder folder;
  folder.write();
  const auto item = [](const std::string& name) {
    DicomFile record;
    record.text(0x00041500, "CS", "SCAN\\" + name);
    const std::string body = record.bytes().substr(132).substr(DicomFile().bytes().size() - 132);
    std::string head("\xfe\xff\x00\xe0\0\0\0\0", 8);
    head[4] = static_cast<char>(body.size());
    return head + body;
  };
  std::string records;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    records += item(entry.path().filename().string());
  std::filesystem::rename(folder.path(), folder / "SCAN");
  DicomFile directory;
  directory.raw(0x00041220, "SQ", records);
  const auto path = write_file(folder / "DICOMDIR", directory.bytes());
  expect_slices(*open_path(path), folder.volume);
  directory.raw(0x00041220, "SQ", records + item("I99"));
  expect_says(folder.complaint("DICOMDIR", to_bytes(directory.bytes())),
              {"names", "SCAN/I99, which is not there"});
  directory.raw(0x00041220, "SQ", item("..\\..\\I1"));
  expect_says(folder.complaint("DICOMDIR", to_bytes(directory.bytes())), {"--follow"});
  directory.raw(0x00041220, "SQ", "");
  expect_says(folder.complaint("DICOMDIR", to_bytes(directory.bytes())), {"names no files"});
}

}  // namespace
}  // namespace voxweld::testing
