#include "tests/fuzz/coverage/entries.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <stdexcept>

#include "storage/support/error.h"

namespace voxweld::testing {
namespace {

double seconds_of(const rusage& use) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(use.ru_utime) + seconds(use.ru_stime);
}

// Of this process and of the children it waited for, in which libraries are tried out.
double processor_seconds() {
  rusage own{}, children{};
  getrusage(RUSAGE_SELF, &own);
  getrusage(RUSAGE_CHILDREN, &children);
  return seconds_of(own) + seconds_of(children);
}

}  // namespace

const std::vector<ParserEntry>& parser_entries() {
  static const std::vector<ParserEntry> all = [] {
    std::vector<ParserEntry> entries = volume_entries();
    for (auto* more : {&text_entries, &store_entries})
      for (ParserEntry& entry : more()) entries.push_back(std::move(entry));
    return entries;
  }();
  return all;
}

const ParserEntry* parser_named(std::string_view name) {
  const auto found = std::ranges::find(parser_entries(), name, &ParserEntry::name);
  return found == parser_entries().end() ? nullptr : &*found;
}

FeedEnd feed(const ParserEntry& entry, Bytes bytes, const FeedLimits& limits) {
  const double begin = processor_seconds();
  FeedEnd end = FeedEnd::accepted;
  try {
    entry.parse(entry, bytes);
  } catch (const Error&) {
    end = FeedEnd::refused;
  }
  if (const double took = processor_seconds() - begin; took > limits.seconds)
    throw std::logic_error(
        fmt::format("{} bytes took {:.1f} s, more than {} s", bytes.size(), took, limits.seconds));
  return end;
}

}  // namespace voxweld::testing
