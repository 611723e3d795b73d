// What tests of the filters keep and fill share: a context, rules, and what is left of a volume.
#pragma once

#include "pipeline/filter/piece_pass.h"
#include "pipeline/filter/pieces.h"
#include "tests/support/piece_volumes.h"
#include "tests/support/temp_directory.h"

namespace voxweld::testing {

using What = PieceRule::What;
inline constexpr Hash128 test_key{3, 4};

struct Setting {
  LocalExecutor executor;
  InterruptFlag interrupt;
  RunContext context;
  explicit Setting(int threads = 2) {
    context.executor = &executor;
    context.interrupt = &interrupt;
    context.console = std::make_shared<Console>(ConsoleSettings{});
    context.progress.enabled = false;
    context.threads = threads;
    context.config.run.memory = std::uint64_t{4} << 30;
  }
};

inline PieceRule rule_of(What what, std::uint64_t voxels, Inside inside = Inside::above) {
  PieceRule rule;
  rule.what = what;
  rule.voxels = voxels;
  rule.isovalue = 95.5;
  rule.inside = inside;
  return rule;
}

inline std::shared_ptr<SampleSource> filtered(const HeldVolume& volume,
                                              const std::filesystem::path& path) {
  return pieces_source(std::make_shared<HeldVolume>(volume), path, test_key);
}

inline std::vector<std::byte> read_box(const SampleSource& source, const Box3& box) {
  std::vector<std::byte> out(static_cast<std::size_t>(box.count()) *
                             sample_bytes(source.info().type));
  source.read(box, out.data());
  return out;
}

}  // namespace voxweld::testing
