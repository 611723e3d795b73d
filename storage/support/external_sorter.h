// Records put in order in bounded memory: whenever the memory allowed is full its records are
// sorted and written to a scratch file as one run, and in the end all runs are merged while they
// are read. Records that compare equal may become one, or go away, wherever they meet.
//
// Based on: Knuth, "The Art of Computer Programming", volume 3, section 5.4, "External Sorting".
#pragma once

#include <algorithm>
#include <cassert>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "storage/support/run_file.h"

namespace voxweld {

// What is sorted, and how. A record is a head of fixed size and, where there is tail_bytes(), that
// many bytes behind it.
//   struct Order {
//     using Head = ...;                                       // trivially copyable
//     static bool less(const Head& a, const Head& b);         // a strict weak order
//     static std::uint64_t tail_bytes(const Head& head);      // optional
//     static bool join(Head& into, const Head& next);         // optional, of records without tail
//   };
// join: `next` compares equal to `into`, which is to stand for both; false where the two cancel. It
// must not matter which of several are joined first.
template <class Order>
constexpr bool has_tails = requires(const typename Order::Head& head) {
  Order::tail_bytes(head);
};
template <class Order>
constexpr bool has_join = requires(typename Order::Head& into) {
  Order::join(into, into);
};

// Sorted runs, read as one. Records that compare equal come in the order of their runs.
template <class Order>
class RunMerge {
 public:
  using Head = typename Order::Head;

  // window: bytes held of each run.
  RunMerge(const RunFile& file, std::span<const RunExtent> runs, std::uint64_t window) {
    runs_.reserve(runs.size());
    for (const RunExtent& run : runs) {
      runs_.push_back({RunReader(file, run, window), {}});
      if (runs_.back().reader.empty()) continue;
      heap_.push_back(runs_.size() - 1);
      runs_.back().advance();
    }
    std::make_heap(heap_.begin(), heap_.end(), Later{&runs_});
  }

  bool next(Head& head, std::vector<std::byte>& tail) {
    while (!heap_.empty()) {
      take(head, tail);
      if constexpr (has_join<Order>) {
        if (!join_equal(head, tail)) continue;
      }
      return true;
    }
    return false;
  }

 private:
  struct Run {
    RunReader reader;
    Head head;
    void advance() { reader.read(std::as_writable_bytes(std::span(&head, 1))); }
  };
  struct Later {
    const std::vector<Run>* runs;
    bool operator()(std::size_t a, std::size_t b) const {
      const Head &p = (*runs)[a].head, &q = (*runs)[b].head;
      if (Order::less(p, q)) return false;
      return Order::less(q, p) || a > b;
    }
  };

  void take(Head& head, std::vector<std::byte>& tail) {
    std::pop_heap(heap_.begin(), heap_.end(), Later{&runs_});
    Run& run = runs_[heap_.back()];
    head = run.head;
    if constexpr (has_tails<Order>) {
      tail.resize(Order::tail_bytes(head));
      run.reader.read(tail);
    }
    if (run.reader.empty()) {
      heap_.pop_back();
      return;
    }
    run.advance();
    std::push_heap(heap_.begin(), heap_.end(), Later{&runs_});
  }

  // False where nothing is left of them.
  bool join_equal(Head& head, std::vector<std::byte>& tail) {
    bool left = true;
    while (!heap_.empty() && !Order::less(head, runs_[heap_.front()].head)) {
      Head other;
      take(other, tail);
      if (left)
        left = Order::join(head, other);
      else
        left = true, head = other;
    }
    return left;
  }

  std::vector<Run> runs_;
  std::vector<std::size_t> heap_;  // of runs by their next record, the lowest first
};

template <class Order>
class ExternalSorter {
 public:
  using Head = typename Order::Head;
  static_assert(std::is_trivially_copyable_v<Head>);
  static_assert(!has_join<Order> || !has_tails<Order>);

  // folder: for the scratch file, which is made only when records do not fit. limit: bytes of
  // records held at once, and one record of any size; an eighth more while runs are merged, or
  // 256 KiB where that is more. Runs are merged when there are as many as are read well at once:
  // 64, or one for every 64 KiB of `limit`. On disk lies what was spilled, and as much again for
  // each time that all of it was merged.
  ExternalSorter(std::filesystem::path folder, std::uint64_t limit)
      : folder_(std::move(folder)),
        limit_(limit),
        runs_merged_(std::max<std::size_t>(64, limit >> 16)) {}

  bool spilled() const { return file_.has_value(); }

  // Before the first next().
  void push(const Head& head, std::span<const std::byte> tail = {}) {
    assert(!reading_);
    make_room(tail.size());
    entries_.push_back({head, tails_.size()});
    if constexpr (has_tails<Order>) tails_.insert(tails_.end(), tail.begin(), tail.end());
  }
  // The same of records that are in order, no two equal: straight to the scratch file, as a run.
  void push_run(std::span<const Head> heads) {
    static_assert(!has_tails<Order>);
    assert(!reading_);
    file().write(std::as_bytes(heads));
    add_run();
  }

  // After the last push: the records in ascending order; those that compare equal as they were
  // pushed, where they are not joined. False after the last.
  bool next(Head& head, std::vector<std::byte>& tail) {
    if (!reading_) begin_reading();
    if (merge_) return merge_->next(head, tail);
    if (next_ == entries_.size()) return false;
    const Entry& entry = entries_[next_++];
    head = entry.head;
    if constexpr (has_tails<Order>) {
      const std::byte* bytes = tails_.data() + entry.tail;
      tail.assign(bytes, bytes + Order::tail_bytes(head));
    }
    return true;
  }
  bool next(Head& head) {
    static_assert(!has_tails<Order>);
    return next(head, tails_);
  }

  // Forgets all, for other records.
  void clear() {
    merge_.reset();
    runs_.clear();
    file_.reset();
    entries_.clear();
    tails_.clear();
    next_ = 0;
    reading_ = false;
  }

 private:
  static constexpr std::uint64_t least_window = 4096, most_window = std::uint64_t{1} << 20;

  struct NoTail {
    NoTail(std::size_t) {}
  };
  struct Entry {
    Head head;
    [[no_unique_address]] std::conditional_t<has_tails<Order>, std::uint64_t, NoTail> tail;
  };
  static_assert(has_tails<Order> || sizeof(Entry) == sizeof(Head));
  struct Run {
    RunExtent extent;
    int level = 0;  // how often its records were merged
  };

  std::uint64_t held_bytes() const { return entries_.size() * sizeof(Entry) + tails_.size(); }

  void make_room(std::uint64_t tail) {
    if (entries_.empty()) {  // untouched, what is reserved takes no memory
      entries_.reserve(limit_ / sizeof(Entry) + 1);
      if constexpr (has_tails<Order>) tails_.reserve(limit_);
      return;
    }
    if (held_bytes() + sizeof(Entry) + tail <= limit_) return;
    sort_held();
    if (has_join<Order> && held_bytes() <= limit_ / 2) return;
    spill();
  }

  void sort_held() {
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      if constexpr (!has_tails<Order>) {
        return Order::less(a.head, b.head);
      } else {  // tails lie as they came; one without bytes lies where the next one does
        if (Order::less(a.head, b.head)) return true;
        if (Order::less(b.head, a.head)) return false;
        if (a.tail != b.tail) return a.tail < b.tail;
        return Order::tail_bytes(a.head) < Order::tail_bytes(b.head);
      }
    });
    if constexpr (has_join<Order>) {
      std::size_t kept = 0;
      for (const Entry& entry : entries_) {
        if (kept == 0 || Order::less(entries_[kept - 1].head, entry.head))
          entries_[kept++] = entry;
        else if (!Order::join(entries_[kept - 1].head, entry.head))
          --kept;
      }
      entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(kept), entries_.end());
    }
  }

  // Precondition: what is held is in order.
  void spill() {
    if constexpr (has_tails<Order>)
      for (const Entry& entry : entries_)
        write(entry.head, std::span(tails_).subspan(entry.tail, Order::tail_bytes(entry.head)));
    else
      file().write(std::as_bytes(std::span(entries_)));
    entries_.clear();
    tails_.clear();
    add_run();
  }
  void write(const Head& head, std::span<const std::byte> tail) {
    file().write(std::as_bytes(std::span(&head, 1)));
    if constexpr (has_tails<Order>) file().write(tail);
  }
  RunFile& file() { return file_ ? *file_ : file_.emplace(folder_); }

  // The run that was written last; where enough are of one level they become one of the next.
  void add_run() {
    runs_.push_back({file().end_run(), 0});
    for (int level = 0; runs_.size() >= runs_merged_; ++level) {
      if (runs_[runs_.size() - runs_merged_].level != level) return;
      std::vector<std::byte> tail;
      Head head;
      RunMerge<Order> merge = merge_of(std::span(runs_).last(runs_merged_), limit_ / 8);
      while (merge.next(head, tail)) write(head, tail);
      runs_.resize(runs_.size() - runs_merged_);
      runs_.push_back({file().end_run(), level + 1});
    }
  }
  RunMerge<Order> merge_of(std::span<const Run> runs, std::uint64_t memory) {
    std::vector<RunExtent> extents;
    for (const Run& run : runs) extents.push_back(run.extent);
    return {file(), extents, std::clamp(memory / runs.size(), least_window, most_window)};
  }

  void begin_reading() {
    reading_ = true;
    sort_held();
    if (!file_) return;
    if (!entries_.empty()) spill();
    entries_ = {};
    tails_ = {};
    merge_.emplace(merge_of(runs_, limit_));
  }

  std::filesystem::path folder_;
  std::uint64_t limit_;
  std::size_t runs_merged_;
  std::vector<Entry> entries_;
  std::vector<std::byte> tails_;
  std::optional<RunFile> file_;
  std::vector<Run> runs_;  // levels fall
  std::optional<RunMerge<Order>> merge_;
  std::size_t next_ = 0;  // of the entries, while nothing was spilled
  bool reading_ = false;
};

}  // namespace voxweld
