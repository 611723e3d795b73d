// Reading slice numbers out of file names.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace voxweld {

// A path without its extension, cut into runs of digits and what lies between.
struct NumberedName {
  std::string form;                   // each run of digits replaced by '#'
  std::vector<std::int64_t> numbers;  // runs of more than 18 digits stay text
};
NumberedName split_numbers(std::string_view path_without_extension);

struct NumberGap {
  std::int64_t first = 0, last = 0;  // missing numbers, both ends included
};

// What the differences of a strictly rising sequence of numbers say.
struct NumberSequence {
  std::int64_t step = 1;
  std::vector<NumberGap> gaps;
};
// The step is 1 unless every difference is a multiple of a larger one that most of at least two
// differences share. Gaps are the numbers `first, first + step ...` that are not there.
NumberSequence examine_sequence(const std::vector<std::int64_t>& numbers);

// "3, 7 to 9, ..." with at most eight ranges.
std::string describe_gaps(const NumberSequence& sequence);

}  // namespace voxweld
