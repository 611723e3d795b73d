// Which of a stage's units a command is to do: all of them, or a task's share. Units of a stage are
// numbered from 0 in an order that depends on the volume and the config alone.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace voxweld {

class UnitSelection {
 public:
  UnitSelection() = default;  // all
  // "0-63,70,128-130"; InputError naming `option` otherwise.
  static UnitSelection list(std::string_view text, std::string_view option);
  // "K/N": every N-th unit from K on, 0 <= K < N. The N shares of a stage are all of it.
  static UnitSelection part(std::string_view text);

  bool all() const { return ranges_.empty() && parts_ == 1; }
  bool contains(std::uint64_t unit) const;
  std::uint64_t count(std::uint64_t units) const;  // of the first `units` those it contains
  // Of ascending units those it contains, ascending; a list takes no longer for their number.
  std::vector<std::uint64_t> among(std::span<const std::uint64_t> units) const;
  // InputError where the selection names units beyond the `count` that `stage` has.
  void check(std::string_view stage, std::string_view noun, std::uint64_t count) const;

 private:
  struct Range {
    std::uint64_t first = 0, last = 0;
  };
  std::vector<Range> ranges_;  // ascending, apart; empty: all of the part
  std::uint64_t part_ = 0, parts_ = 1;
};

// "0-63,70": what UnitSelection::list takes. Precondition: ascending.
std::string unit_list(const std::vector<std::uint64_t>& units);

}  // namespace voxweld
