#include "storage/vdb/vdb_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/types/sample_type.h"
#include "storage/vdb/vdb_library.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

// What a sound file needs, with room to spare. A node of a tree is up to 32 times as large in memory
// as in the file: empty ones are. The file itself is mapped.
ServiceRules rules_for(std::uint64_t file_bytes) {
  constexpr std::uint64_t mib = std::uint64_t{1} << 20;
  ServiceRules rules;
  rules.most_more_bytes = 256 * mib + 40 * std::min(file_bytes, std::uint64_t{1} << 50);
  rules.most_seconds =
      6 + static_cast<unsigned>(std::min<std::uint64_t>(file_bytes / (8 * mib), 36000));
  return rules;
}

FileState state_of_file(const std::string& path) {
  require_input_file(path);
  return ReadFile(path).state();
}

// What a child says whose memory may be damaged.
void settle(VdbGrid& grid) {
  for (const std::span<char> text : {std::span<char>(grid.name), std::span<char>(grid.type),
                                     std::span<char>(grid.grid_class), std::span<char>(grid.map)})
    text.back() = '\0';
  if (grid.sample > static_cast<std::int32_t>(SampleType::f64)) grid.sample = -1;
}

// In the child, which has one for all calls.
void serve(const std::string& path, std::unique_ptr<VdbLibrary>& library,
           std::span<std::byte> memory) {
  if (!library) library = std::make_unique<VdbLibrary>(path);
  library->answer(*reinterpret_cast<VdbTalk*>(memory.data()));
}

}  // namespace

VdbFile::VdbFile(std::string path)
    : path_(std::move(path)),
      state_(state_of_file(path_)),
      rules_(rules_for(state_.size)),
      child_(
          sizeof(VdbTalk),
          [where = path_, library = std::make_shared<std::unique_ptr<VdbLibrary>>()](
              std::span<std::byte> memory) { serve(where, *library, memory); },
          rules_) {
  talk().file_bytes = state_.size;
  ask(VdbTask::survey, "opening it");
  if (talk().needed_bytes > state_.size)
    throw FormatError(
        fmt::format("{}: truncated: its grids end at byte {}, but the file has {}: get a complete "
                    "copy",
                    path_, talk().needed_bytes, state_.size));
  for (std::size_t i = 0; i < grids().size(); ++i) settle(talk().grid[i]);
}

VdbTalk& VdbFile::talk() const {
  return *reinterpret_cast<VdbTalk*>(child_.memory().data());
}

std::span<const VdbGrid> VdbFile::grids() const {
  return {talk().grid, std::min<std::size_t>(talk().grids, most_vdb_grids)};
}

void VdbFile::ask(VdbTask task, const std::string& what) const {
  talk().task = task;
  const CallEnd end = child_.call();
  switch (end.kind) {
    case CallEnd::Kind::done:
      return;
    case CallEnd::Kind::failed:
      throw FormatError(fmt::format("{}: {}: OpenVDB: {}: get a sound copy", path_, what, end.why));
    case CallEnd::Kind::crashed:
      throw FormatError(fmt::format(
          "{}: {}: OpenVDB crashes, or wants more than {} MiB of memory: it may be damaged: get a "
          "sound copy",
          path_, what, rules_.most_more_bytes >> 20));
    case CallEnd::Kind::out_of_time:
      throw FormatError(fmt::format(
          "{}: {}: OpenVDB works on it for more than {} s: it may be damaged: get a sound copy",
          path_, what, rules_.most_seconds));
  }
}

VdbFile::OpenGrid VdbFile::open(std::size_t grid) {
  talk().chosen = static_cast<std::uint32_t>(grid);
  ask(VdbTask::open, fmt::format("grid '{}'", grids()[grid].name));
  OpenGrid opened{{}, talk().tree_bytes};
  if (!talk().active) return opened;
  for (int a = 0; a < 3; ++a) {
    opened.active.lo[a] = talk().first[a];
    opened.active.hi[a] = talk().last[a] + 1;
  }
  return opened;
}

void VdbFile::read(const Box3& box, std::size_t bytes, std::byte* out) const {
  const std::lock_guard lock(one_);
  talk().box = box;
  ask(VdbTask::read, fmt::format("the voxels from ({}, {}, {}) to ({}, {}, {})", box.lo.x, box.lo.y,
                                 box.lo.z, box.hi.x - 1, box.hi.y - 1, box.hi.z - 1));
  std::memcpy(out, talk().samples, static_cast<std::size_t>(box.count()) * bytes);
}

}  // namespace voxweld
