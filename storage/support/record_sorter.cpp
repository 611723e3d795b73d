#include "storage/support/record_sorter.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

namespace voxweld {
namespace {

constexpr std::uint64_t least_buffer = 4096, most_buffer = std::uint64_t{1} << 20;

struct RunRecord {  // before each record of a run
  SortKey key;
  std::uint64_t size = 0;
};
static_assert(sizeof(RunRecord) == 24);

}  // namespace

// One run while it is merged: a window of the scratch file that moves on.
class RecordSorter::Run {
 public:
  Run(const ScratchFile& file, std::uint64_t begin, std::uint64_t end)
      : file_(file), at_(begin), end_(end) {}

  void begin(std::uint64_t buffer) {
    buffer_bytes_ = buffer;
    advance();
  }
  bool done() const { return done_; }
  const SortKey& key() const { return record_.key; }

  void take(std::vector<std::byte>& record) {
    record.resize(record_.size);
    read(record);
    advance();
  }

 private:
  void advance() {
    done_ = at_ == end_ && next_ == buffer_.size();
    if (done_)
      buffer_ = {};
    else
      read(std::as_writable_bytes(std::span(&record_, 1)));
  }
  void read(std::span<std::byte> out) {
    while (!out.empty()) {
      if (next_ == buffer_.size()) {
        buffer_.resize(std::min(buffer_bytes_, end_ - at_));
        file_.read(at_, buffer_);
        at_ += buffer_.size();
        next_ = 0;
      }
      const std::size_t part = std::min(out.size(), buffer_.size() - next_);
      std::memcpy(out.data(), buffer_.data() + next_, part);
      next_ += part;
      out = out.subspan(part);
    }
  }

  const ScratchFile& file_;
  std::uint64_t at_, end_;  // of the file: what is still to be read
  std::uint64_t buffer_bytes_ = least_buffer;
  std::vector<std::byte> buffer_;
  std::size_t next_ = 0;
  RunRecord record_;
  bool done_ = false;
};

RecordSorter::RecordSorter(std::filesystem::path folder, std::uint64_t limit)
    : folder_(std::move(folder)), limit_(limit) {}

RecordSorter::~RecordSorter() = default;

void RecordSorter::push(SortKey key, std::span<const std::byte> record) {
  assert(!reading_);
  if (held_.capacity() == 0) held_.reserve(limit_);  // untouched, it takes no memory
  const std::uint64_t taken = held_.size() + entries_.size() * sizeof(Entry);
  if (!entries_.empty() && taken + record.size() + sizeof(Entry) > limit_) spill();
  entries_.push_back({key, held_.size(), record.size()});
  held_.insert(held_.end(), record.begin(), record.end());
  ++size_;
}

void RecordSorter::sort_held() {
  // Offsets rise as records come: equal keys stay in their order.
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return a.key != b.key ? a.key < b.key : a.offset < b.offset;
  });
}

void RecordSorter::spill() {
  if (scratch_ == nullptr) scratch_ = std::make_unique<ScratchFile>(folder_);
  sort_held();
  const std::uint64_t begin = scratch_->size();
  std::vector<std::byte> piece;
  piece.reserve(most_buffer);
  const auto write = [&](std::span<const std::byte> bytes) {
    if (piece.size() + bytes.size() > most_buffer) {
      scratch_->append(piece);
      piece.clear();
    }
    if (bytes.size() > most_buffer)
      scratch_->append(bytes);
    else
      piece.insert(piece.end(), bytes.begin(), bytes.end());
  };
  for (const Entry& entry : entries_) {
    const RunRecord record{entry.key, entry.size};
    write(std::as_bytes(std::span(&record, 1)));
    write(std::span(held_).subspan(entry.offset, entry.size));
  }
  scratch_->append(piece);
  runs_.push_back(std::make_unique<Run>(*scratch_, begin, scratch_->size()));
  entries_.clear();
  held_.clear();
}

void RecordSorter::begin_reading() {
  reading_ = true;
  if (scratch_ == nullptr) return sort_held();
  if (!entries_.empty()) spill();
  entries_ = {};
  held_ = {};
  const std::uint64_t buffer = std::clamp(limit_ / runs_.size(), least_buffer, most_buffer);
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    runs_[i]->begin(buffer);
    heap_.push_back(i);
  }
  std::make_heap(heap_.begin(), heap_.end(),
                 [&](std::size_t a, std::size_t b) { return comes_later(a, b); });
}

// Of equal keys those of the earlier run came first.
bool RecordSorter::comes_later(std::size_t a, std::size_t b) const {
  return runs_[a]->key() != runs_[b]->key() ? runs_[a]->key() > runs_[b]->key() : a > b;
}

bool RecordSorter::next(SortKey& key, std::vector<std::byte>& record) {
  if (!reading_) begin_reading();
  return scratch_ == nullptr ? next_held(key, record) : next_merged(key, record);
}

bool RecordSorter::next_held(SortKey& key, std::vector<std::byte>& record) {
  if (next_entry_ == entries_.size()) return false;
  const Entry& entry = entries_[next_entry_++];
  const auto begin = held_.begin() + static_cast<std::ptrdiff_t>(entry.offset);
  key = entry.key;
  record.assign(begin, begin + static_cast<std::ptrdiff_t>(entry.size));
  return true;
}

bool RecordSorter::next_merged(SortKey& key, std::vector<std::byte>& record) {
  const auto later = [&](std::size_t a, std::size_t b) { return comes_later(a, b); };
  if (heap_.empty()) return false;
  std::pop_heap(heap_.begin(), heap_.end(), later);
  Run& run = *runs_[heap_.back()];
  key = run.key();
  run.take(record);
  if (run.done())
    heap_.pop_back();
  else
    std::push_heap(heap_.begin(), heap_.end(), later);
  return true;
}

void RecordSorter::clear() {
  size_ = 0;
  held_.clear();
  entries_.clear();
  heap_.clear();
  runs_.clear();
  scratch_.reset();
  next_entry_ = 0;
  reading_ = false;
}

}  // namespace voxweld
