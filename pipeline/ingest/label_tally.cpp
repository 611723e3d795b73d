#include "pipeline/ingest/label_tally.h"

#include <algorithm>
#include <queue>
#include <utility>

namespace voxweld {
namespace {

constexpr std::size_t runs_merged = 16;   // at once
constexpr std::size_t counts_read = 256;  // of a run at once
constexpr std::size_t most_runs =
    std::size_t{8} * 16;  // there are never so many: 16^8 times a full table

// Adjacent counts of a label become one.
class Joined {
 public:
  explicit Joined(const std::function<void(const LabelCount&)>& f) : f_(f) {}
  void next(const LabelCount& count) {
    if (sum_.voxels != 0 && sum_.label == count.label) return add(sum_, count);
    flush();
    sum_ = count;
  }
  void flush() {
    if (sum_.voxels != 0) f_(sum_);
    sum_ = LabelCount{};
  }

 private:
  const std::function<void(const LabelCount&)>& f_;
  LabelCount sum_;
};

}  // namespace

// One sorted sequence: a run of the file, or counts in memory.
class LabelTally::Reader {
 public:
  Reader(const ScratchFile* file, Run run) : file_(file), offset_(run.offset), left_(run.count) {
    refill();
  }
  explicit Reader(std::span<const LabelCount> counts) : counts_(counts) {}

  bool empty() const { return counts_.empty(); }
  const LabelCount& first() const { return counts_.front(); }
  void pop() {
    counts_ = counts_.subspan(1);
    if (counts_.empty() && left_ > 0) refill();
  }

 private:
  void refill() {
    const std::size_t count = std::min<std::uint64_t>(left_, counts_read);
    buffer_.resize(count);
    file_->read(offset_, std::as_writable_bytes(std::span(buffer_)));
    offset_ += count * sizeof(LabelCount);
    left_ -= count;
    counts_ = buffer_;
  }

  const ScratchFile* file_ = nullptr;
  std::uint64_t offset_ = 0, left_ = 0;
  std::vector<LabelCount> buffer_;
  std::span<const LabelCount> counts_;
};

LabelTally::LabelTally(std::filesystem::path folder, std::size_t most)
    : folder_(std::move(folder)), table_(most) {}

std::uint64_t LabelTally::memory_bytes(std::size_t most) {
  return LabelTable::memory_bytes(most) + (most_runs + 1) * counts_read * sizeof(LabelCount);
}

std::size_t LabelTally::labels_within(std::uint64_t bytes) {
  std::size_t most = 1;
  while (memory_bytes(2 * most) <= bytes) most *= 2;
  return most;
}

void LabelTally::add(SampleType type, const Box3& box, std::span<const std::byte> samples) {
  const auto count = static_cast<std::uint64_t>(box.count());
  for (std::uint64_t at = 0; (at = table_.add(type, box, samples, at)) < count;) spill();
}

void LabelTally::add(const LabelCount& count) {
  while (!table_.add(count)) spill();
}

void LabelTally::merge(std::span<const Run> runs, std::span<const LabelCount> more,
                       const std::function<void(const LabelCount&)>& f) const {
  std::vector<Reader> readers;
  readers.reserve(runs.size() + 1);
  for (const Run& run : runs) readers.emplace_back(file_.get(), run);
  readers.emplace_back(more);
  using Head = std::pair<std::uint64_t, std::size_t>;  // a label and its reader
  std::priority_queue<Head, std::vector<Head>, std::greater<>> heads;
  for (std::size_t i = 0; i < readers.size(); ++i)
    if (!readers[i].empty()) heads.emplace(readers[i].first().label, i);
  Joined joined(f);
  while (!heads.empty()) {
    const std::size_t i = heads.top().second;
    heads.pop();
    joined.next(readers[i].first());
    readers[i].pop();
    if (!readers[i].empty()) heads.emplace(readers[i].first().label, i);
  }
  joined.flush();
}

// The last runs, all of that level, become one of the next.
void LabelTally::merge_last(int level) {
  Run merged{file_->size(), 0, level + 1};
  std::vector<LabelCount> buffer;
  const auto write = [&] {
    file_->append(std::as_bytes(std::span(buffer)));
    buffer.clear();
  };
  const auto last = std::span(runs_).last(runs_merged);
  merge(last, {}, [&](const LabelCount& count) {
    ++merged.count;
    buffer.push_back(count);
    if (buffer.size() == counts_read) write();
  });
  write();
  runs_.resize(runs_.size() - runs_merged);
  runs_.push_back(merged);
}

void LabelTally::spill() {
  if (!file_) file_ = std::make_unique<ScratchFile>(folder_);
  const std::span<const LabelCount> counts = table_.take();
  const std::uint64_t offset = file_->append(std::as_bytes(counts));
  runs_.push_back({offset, counts.size(), 0});
  for (int level = 0; runs_.size() >= runs_merged; ++level) {
    if (runs_[runs_.size() - runs_merged].level != level) break;
    merge_last(level);
  }
}

void LabelTally::finish(const std::function<void(const LabelCount&)>& f) {
  merge(runs_, table_.take(), f);
  table_.clear();
  runs_.clear();
  file_.reset();
}

}  // namespace voxweld
