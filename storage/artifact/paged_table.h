// Tables too long to be held whole: records of one size, in pages, each page a section of an
// artifact, named one after the other.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "storage/artifact/container.h"

namespace voxweld {

inline constexpr std::uint64_t page_records = 1024;

template <class T, std::uint64_t most = page_records>
class PagedTableWriter {
  static_assert(std::is_trivially_copyable_v<T>);  // written as it lies in memory: no padding

 public:
  PagedTableWriter(ArtifactWriter& file, std::uint64_t first_page)
      : file_(file), first_page_(first_page) {}

  std::uint64_t size() const { return size_; }
  void push(const T& record) {
    ++size_;
    pending_.push_back(record);
    if (pending_.size() == most) flush();
  }
  // After the last. The number of records is for another section to keep.
  void finish() {
    if (!pending_.empty()) flush();
  }

 private:
  void flush() {
    file_.section(first_page_ + pages_++, std::as_bytes(std::span(pending_)));
    pending_.clear();
  }
  ArtifactWriter& file_;
  std::uint64_t first_page_, pages_ = 0, size_ = 0;
  std::vector<T> pending_;
};

// Nothing is held: each call reads the pages it needs. Thread-safe.
template <class T>
class PagedTable {
 public:
  PagedTable(const ArtifactReader& file, std::uint64_t first_page, std::uint64_t size)
      : file_(file), first_page_(first_page), size_(size) {}

  std::uint64_t size() const { return size_; }

  // The records [first, first + count). DamagedArtifact where there are fewer.
  std::vector<T> read(std::uint64_t first, std::uint64_t count) const {
    std::vector<T> found, page;
    if (first > size_ || count > size_ - first)
      file_.damaged("a table is shorter than referred to");
    found.reserve(count);
    for (std::uint64_t at = first; at < first + count;) {
      read_page(at / page_records, page);
      const std::uint64_t from = at % page_records;
      const std::uint64_t part = std::min(first + count - at, page.size() - from);
      found.insert(found.end(), page.begin() + static_cast<std::ptrdiff_t>(from),
                   page.begin() + static_cast<std::ptrdiff_t>(from + part));
      at += part;
    }
    return found;
  }

  // Of the records [first, first + count) those that are neither `before` nor `after`: before holds
  // of the first of them only, after of the last.
  template <class Before, class After>
  std::vector<T> between(std::uint64_t first, std::uint64_t count, const Before& before,
                         const After& after) const {
    std::uint64_t begin = first, end = first + count;
    if (count > page_records) {
      begin = partition_point(first, first + count, before);
      end = partition_point(begin, first + count, [&](const T& record) { return !after(record); });
    }
    std::vector<T> found = read(begin, end - begin);
    std::erase_if(found, [&](const T& record) { return before(record) || after(record); });
    return found;
  }

 private:
  // The first index in [begin, end) whose record is not `before`, or end.
  template <class Before>
  std::uint64_t partition_point(std::uint64_t begin, std::uint64_t end,
                                const Before& before) const {
    while (begin < end) {
      const std::uint64_t middle = begin + (end - begin) / 2;
      if (before(read(middle, 1).front()))
        begin = middle + 1;
      else
        end = middle;
    }
    return begin;
  }
  void read_page(std::uint64_t number, std::vector<T>& page) const {
    file_.read_array(first_page_ + number, page);
    const std::uint64_t expected = std::min(page_records, size_ - number * page_records);
    if (page.size() != expected) file_.damaged("a page of a table has another size than it should");
  }
  const ArtifactReader& file_;
  std::uint64_t first_page_, size_;
};

}  // namespace voxweld
