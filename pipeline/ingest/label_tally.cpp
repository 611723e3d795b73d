#include "pipeline/ingest/label_tally.h"

namespace voxweld {

std::uint64_t LabelTally::memory_bytes(std::size_t most) {
  return LabelTable::memory_bytes(most) + merge_bytes;
}

std::size_t LabelTally::labels_within(std::uint64_t bytes) {
  std::size_t most = 1;
  while (memory_bytes(2 * most) <= bytes) most *= 2;
  return most;
}

void LabelTally::add(SampleType type, const Box3& box, std::span<const std::byte> samples) {
  const auto count = static_cast<std::uint64_t>(box.count());
  for (std::uint64_t at = 0; (at = table_.add(type, box, samples, at)) < count;)
    spilled_.push_run(table_.take());
}

void LabelTally::add(const LabelCount& count) {
  while (!table_.add(count)) spilled_.push_run(table_.take());
}

void LabelTally::finish(const std::function<void(const LabelCount&)>& f) {
  if (spilled_.spilled()) {
    spilled_.push_run(table_.take());
    LabelCount count;
    while (spilled_.next(count)) f(count);
  } else {
    for (const LabelCount& count : table_.take()) f(count);
  }
  table_.clear();
  spilled_.clear();
}

}  // namespace voxweld
