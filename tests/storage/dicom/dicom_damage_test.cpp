// Run lengths, fragments and their tables of offsets: sound, and damaged.
#include "tests/storage/dicom/dicom_folder.h"

namespace voxweld::testing {
namespace {

std::string u32(std::size_t value) {
  std::string out;
  for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 0xff);
  return out;
}

// Run lengths of a slice of 16 bits: runs where values repeat, else literals of at most `most`.
std::string run_lengths(const Bytes& samples, std::size_t most) {
  std::string planes[2];
  for (std::size_t p = 0; p < 2; ++p) {
    std::string bytes;
    for (std::size_t i = 1 - p; i < samples.size(); i += 2) bytes += static_cast<char>(samples[i]);
    for (std::size_t at = 0; at < bytes.size();) {
      std::size_t run = 1;
      while (run < 128 && at + run < bytes.size() && bytes[at + run] == bytes[at]) ++run;
      if (run > 1) {
        planes[p] += static_cast<char>(257 - run);
        planes[p] += bytes[at];
        at += run;
        continue;
      }
      const std::size_t count = std::min(most, bytes.size() - at);
      planes[p] += static_cast<char>(count - 1);
      planes[p] += bytes.substr(at, count);
      at += count;
    }
  }
  return u32(2) + u32(64) + u32(64 + planes[0].size()) + std::string(52, '\0') + planes[0] +
         planes[1];
}

class DicomRuns : public ::testing::Test {
 protected:
  DicomRuns() {
    // Every third value repeats, so that there are runs and literals.
    for (std::size_t i = 2; i + 1 < volume.samples.size(); i += 6) {
      volume.samples[i] = volume.samples[i - 2];
      volume.samples[i + 1] = volume.samples[i - 1];
    }
    const Index3 n = volume.size;
    file = ct_slice({.columns = static_cast<int>(n.x), .rows = static_cast<int>(n.y)});
    file.text(0x00280008, "IS", std::to_string(n.z)).text(0x00180088, "DS", "2");
    for (std::int64_t z = 0; z < n.z; ++z)
      frames.push_back(run_lengths(volume.box({{0, 0, z}, {n.x, n.y, z + 1}}), 20));
    form.syntax = "1.2.840.10008.1.2.5";
  }
  std::string bytes(const std::vector<std::string>& items) {
    return file.fragments(items).bytes(form);
  }

  KnownVolume volume = make_volume(SampleType::i16, {9, 7, 4});
  DicomFile file;
  DicomForm form;
  std::vector<std::string> frames;
  const VolumeFolder folder;
};

TEST_F(DicomRuns, AreUnpacked) {
  const auto source = folder.open("a", to_bytes(bytes(frames)));
  expect_slices(*source, volume);
  EXPECT_GT(source->info().largest_decode, 2 * 9 * 7 * 2U);
}

// Two fragments a frame, which only a table of offsets tells apart.
TEST_F(DicomRuns, InSeveralFragments) {
  std::vector<std::string> pieces;
  std::string table;
  std::size_t at = 0;
  for (const std::string& frame : frames) {
    table += u32(at);
    pieces.push_back(frame.substr(0, 70));
    pieces.push_back(frame.substr(70));
    at += frame.size() + 16;
  }
  std::string whole = bytes(pieces);
  expect_says(folder.complaint("a", to_bytes(whole)),
              {"4 frames are in 8 fragments, and no table"});
  const std::string empty("\xfe\xff\x00\xe0\0\0\0\0", 8);
  const std::size_t place = whole.find(empty);
  whole.replace(place, 8, std::string("\xfe\xff\x00\xe0", 4) + u32(table.size()) + table);
  expect_slices(*folder.open("a", to_bytes(whole)), volume);
  whole[place + 8 + 5] = 1;
  expect_says(folder.complaint("a", to_bytes(whole)), {"frame 2 does not begin where"});
}

TEST_F(DicomRuns, DamageIsToldByFrame) {
  std::vector<std::string> damaged = frames;
  damaged[2][0] = 3;
  expect_says(folder.complaint("a", to_bytes(bytes(damaged))),
              {"a, frame 3: its run lengths are in 3 segments"});
  damaged = frames;
  damaged[1][8] = '\xff';
  expect_says(folder.complaint("a", to_bytes(bytes(damaged))),
              {"a, frame 2: segment 1 of its run lengths is damaged"});
  damaged = frames;
  damaged[3].resize(80);
  expect_says(folder.complaint("a", to_bytes(bytes(damaged))), {"a, frame 4: segment"});
  damaged[3].clear();
  expect_says(folder.complaint("a", to_bytes(bytes(damaged))), {"a, frame 4: has no samples"});
}

TEST_F(DicomRuns, CutShortAnywhere) {
  const Bytes whole = to_bytes(bytes(frames));
  // The last 8 bytes are the end of the sequence, without which all samples are there.
  const Bytes samples(whole.begin(), whole.end() - 8);
  folder.expect_cuts_refused("a.dcm", samples, 1);
  expect_slices(*folder.open("a.dcm", samples), volume);
}

TEST_F(DicomRuns, FlippedBytesAreErrorsOrOtherValues) {
  const Bytes whole = to_bytes(bytes(frames));
  std::mt19937 random(5);
  for (int i = 0; i < 2000; ++i) {
    Bytes flipped = whole;
    for (int flips = i % 3; flips >= 0; --flips)
      flipped[132 + random() % (whole.size() - 132)] = static_cast<std::byte>(random());
    folder.complaint("a.dcm", flipped);
  }
}

// One damaged file among others is not passed over: a slice would be missing.
TEST(DicomDamage, OfOneSliceIsTold) {
  const DicomFolder scan;
  scan.write();
  std::filesystem::resize_file(scan.file(2), 500);
  expect_says(complaint(scan.path()), {"I2", "copy"});
}

}  // namespace
}  // namespace voxweld::testing
