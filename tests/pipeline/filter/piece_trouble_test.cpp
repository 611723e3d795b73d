// What find_pieces says, refuses and leaves where something is wrong.
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <sstream>

#include "storage/artifact/piece_changes.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/pipeline/filter/piece_setting.h"
#include "tests/support/error_text.h"

namespace voxweld {
namespace {

using testing::error_text;
using testing::filtered;
using testing::held_volume;
using testing::HeldVolume;
using testing::noise;
using testing::read_box;
using testing::rule_of;
using testing::Setting;
using testing::TempDirectory;
using testing::test_key;
using testing::What;

TEST(Pieces, ValueOnTheWrongSide) {
  const TempDirectory directory;
  Setting setting;
  const HeldVolume volume = held_volume(SampleType::u8, {9, 9, 9}, noise(0.3, 4), 1);
  const auto refused = [&](What what, double value, const HeldVolume& of) {
    PieceRule rule = rule_of(what, 1 << 10);
    rule.value = value;
    return error_text<InputError>(
        [&] { find_pieces(setting.context, of, rule, directory / "a", test_key); });
  };
  EXPECT_EQ(refused(What::keep, 95.7, volume),
            "keep: samples become 96, which must lie outside the surface: it is inside (isovalue "
            "95.5, inside above); give another value, or none");
  EXPECT_EQ(refused(What::fill, 95.2, volume).substr(0, 54),
            "fill: samples become 95, which must lie inside the sur");
  EXPECT_EQ(refused(What::keep, -1, volume),
            "keep: the value -1 is none that samples of uint8 can have");
  const HeldVolume full = held_volume(SampleType::u8, {4, 4, 4}, noise(2, 1), 1);
  PieceRule rule = rule_of(What::keep, 65);
  EXPECT_EQ(error_text<InputError>(
                [&] { find_pieces(setting.context, full, rule, directory / "a", test_key); }),
            "keep: no sample of the volume lies outside the surface (isovalue 95.5), so there is "
            "none that the changed ones could become: give a value");
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(Pieces, TellsWhatIsFoundOnceOnly) {
  const TempDirectory directory;
  Setting setting;
  const HeldVolume volume = held_volume(
      SampleType::u8, {40, 40, 8}, [](Index3 p) { return p.x != 30; }, 1);
  std::ostringstream text;
  const auto before = spdlog::default_logger();
  auto logger = std::make_shared<spdlog::logger>(
      "test", std::make_shared<spdlog::sinks::ostream_sink_st>(text));
  logger->set_pattern("%v");
  spdlog::set_default_logger(logger);
  for (int i = 0; i < 2; ++i)
    find_pieces(setting.context, volume, rule_of(What::keep, 0), directory / "a", test_key);
  spdlog::set_default_logger(before);
  EXPECT_EQ(text.str(), "keep: 1 of 2 pieces kept, 2,880 of their 12,480 samples become 0\n");
  EXPECT_TRUE(pieces_are_found(directory / "a", test_key));
  EXPECT_FALSE(pieces_are_found(directory / "a", Hash128{3, 5}));
  EXPECT_FALSE(pieces_are_found(directory / "b", test_key));
}

// An executor of other processes is left alone.
class NobodyHere : public Executor {
 public:
  bool in_process() const override { return false; }
  void run_units(StageName, std::span<const Unit>, const UnitWork&, const RunOptions&) override {
    throw std::logic_error("asked");
  }
};

TEST(Pieces, RunInThisProcess) {
  const TempDirectory directory;
  Setting setting;
  NobodyHere cluster;
  setting.context.executor = &cluster;
  const HeldVolume volume = held_volume(SampleType::u8, {9, 9, 9}, noise(0.3, 4), 1);
  find_pieces(setting.context, volume, rule_of(What::keep, 0), directory / "a", test_key);
  EXPECT_EQ(setting.context.executor, &cluster);
}

// Stops, or fails, when so many boxes were read. The last of these is the 100th.
class TroubledVolume : public HeldVolume {
 public:
  TroubledVolume(const HeldVolume& volume, int good, InterruptFlag* flag)
      : HeldVolume(volume), left_(good), flag_(flag) {}
  void read(const Box3& box, std::byte* out) const override {
    HeldVolume::read(box, out);
    if (--left_ > 0) return;
    if (flag_ == nullptr) throw FormatError("the file ends early");
    flag_->request();
  }

 private:
  mutable std::atomic<int> left_;
  InterruptFlag* flag_;
};

TEST(Pieces, TroubleLeavesNothingBehind) {
  const HeldVolume volume = held_volume(SampleType::u8, {9, 40, 40}, noise(0.3, 4), 1);
  for (const int threads : {1, 4})
    for (const int good : {1, 7, 60, 100}) {
      const TempDirectory directory;
      Setting setting(threads);
      const PieceRule rule = rule_of(What::keep, 0);
      const auto pass = [&](InterruptFlag* flag) {
        const TroubledVolume troubled(volume, good, flag);
        find_pieces_in_blocks(setting.context, troubled, rule, directory / "a", test_key, 4);
      };
      EXPECT_ANY_THROW(pass(nullptr)) << threads << " " << good;
      EXPECT_THROW(pass(&setting.interrupt), Interrupted) << threads << " " << good;
      EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
    }
}

TEST(Pieces, TooManyForTheMemory) {
  const TempDirectory directory;
  Setting setting(1);
  const HeldVolume volume = held_volume(
      SampleType::u8, {256, 256, 8}, [](Index3 p) { return (p.x + p.y + p.z) % 2 == 0; }, 1);
  const auto with = [&](std::uint64_t memory) {
    setting.context.config.run.memory = memory;
    return error_text<InputError>([&] {
      find_pieces_in_blocks(setting.context, volume, rule_of(What::keep, 0), directory / "a",
                            test_key, 4);
    });
  };
  // So small blocks have all their pieces on faces: of 131072 samples a layer takes some 9 MiB, and
  // where a band just fits there are about 3.
  std::uint64_t memory = program_bytes();
  std::string text = with(memory);
  while (text.find("one band of blocks") != std::string::npos) text = with(memory += 1 << 20);
  EXPECT_NE(text.find("in slices 0 to 3"), std::string::npos) << text;
  EXPECT_EQ(with(memory + (64 << 20)), "accepted");
}

TEST(Pieces, DamagedArtifact) {
  const TempDirectory directory;
  Setting setting;
  const PieceRule rule = rule_of(What::keep, 0);
  const HeldVolume volume = held_volume(SampleType::u8, {40, 40, 40}, noise(0.3, 4), 1);
  const auto path = directory / "a";
  const auto read = [&](const HeldVolume& of) {
    read_box(*filtered(of, path), {{}, of.info().geometry.size});
  };
  EXPECT_THROW(read(volume), DamagedArtifact) << "missing";
  find_pieces_in_blocks(setting.context, volume, rule, path, test_key, 7);
  read(volume);
  EXPECT_THROW(read(held_volume(SampleType::u8, {40, 40, 40}, noise(0.3, 5), 1)), DamagedArtifact);
  EXPECT_THROW(read(held_volume(SampleType::u8, {40, 40, 41}, noise(0.3, 4), 1)), DamagedArtifact);
  EXPECT_THROW(read(held_volume(SampleType::i8, {40, 40, 40}, noise(0.3, 4), 1)), DamagedArtifact);
  EXPECT_THROW(
      read_box(*pieces_source(std::make_shared<HeldVolume>(volume), path, {1, 1}), {{}, splat(1)}),
      DamagedArtifact);
  const auto whole = read_whole_file(path);
  for (std::size_t at = 0; at < whole.size(); at += 97) {
    auto damaged = whole;
    damaged[at] ^= std::byte{0x10};
    write_whole_file(path, damaged, Durability::rename_only);
    EXPECT_THROW(read(volume), DamagedArtifact) << at;
  }
  write_whole_file(path, std::span(whole).first(whole.size() / 2), Durability::rename_only);
  EXPECT_THROW(read(volume), DamagedArtifact);
  EXPECT_FALSE(pieces_are_found(path, test_key));
}

}  // namespace
}  // namespace voxweld
