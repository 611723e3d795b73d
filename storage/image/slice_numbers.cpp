#include "storage/image/slice_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>

namespace voxweld {
namespace {

constexpr std::size_t max_digits = 18;
constexpr std::size_t max_ranges = 8;

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

}  // namespace

NumberedName split_numbers(std::string_view path) {
  NumberedName name;
  for (std::size_t i = 0; i < path.size();) {
    std::size_t end = i;
    while (end < path.size() && is_digit(path[end])) ++end;
    if (end == i) {
      name.form += path[i++];
      continue;
    }
    const std::string_view digits = path.substr(i, end - i);
    if (digits.size() > max_digits) {
      name.form += digits;
    } else {
      std::int64_t value = 0;
      std::from_chars(digits.data(), digits.data() + digits.size(), value);
      name.numbers.push_back(value);
      name.form += '#';
    }
    i = end;
  }
  return name;
}

NumberSequence examine_sequence(const std::vector<std::int64_t>& numbers) {
  NumberSequence sequence;
  if (numbers.size() < 2) return sequence;
  std::vector<std::int64_t> differences;
  for (std::size_t i = 1; i < numbers.size(); ++i)
    differences.push_back(numbers[i] - numbers[i - 1]);
  const std::int64_t smallest = *std::min_element(differences.begin(), differences.end());
  const auto shared = std::count(differences.begin(), differences.end(), smallest);
  const bool all_multiples = std::all_of(differences.begin(), differences.end(),
                                         [&](std::int64_t d) { return d % smallest == 0; });
  if (all_multiples && shared >= 2 && 2 * shared > std::ssize(differences))
    sequence.step = smallest;
  for (std::size_t i = 0; i < differences.size(); ++i)
    if (differences[i] != sequence.step)
      sequence.gaps.push_back({numbers[i] + sequence.step, numbers[i + 1] - sequence.step});
  return sequence;
}

std::string describe_gaps(const NumberSequence& sequence) {
  std::string text;
  for (std::size_t i = 0; i < sequence.gaps.size() && i < max_ranges; ++i) {
    const NumberGap& gap = sequence.gaps[i];
    if (!text.empty()) text += ", ";
    text += gap.first == gap.last ? fmt::format("{}", gap.first)
                                  : fmt::format("{} to {}", gap.first, gap.last);
  }
  if (sequence.gaps.size() > max_ranges) text += ", ...";
  return text;
}

}  // namespace voxweld
