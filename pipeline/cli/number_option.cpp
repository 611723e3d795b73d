#include "pipeline/cli/number_option.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pipeline/config/number_list.h"

namespace voxweld {
namespace {

bool is_of(const ConfigValue& value, double) {
  return value.is_number();
}
bool is_of(const ConfigValue& value, std::int64_t) {
  return value.integer() != nullptr;
}
void read(const ConfigValue& value, double& out) {
  out = value.number();
}
void read(const ConfigValue& value, std::int64_t& out) {
  out = *value.integer();
}
const char* noun_of(double) {
  return "number";
}
const char* noun_of(std::int64_t) {
  return "whole number";
}

template <class Number>
std::vector<Number> read_numbers(const std::string& name, const std::vector<std::string>& words,
                                 const std::vector<std::size_t>& counts) {
  const std::string text = fmt::format("{}", fmt::join(words, " "));
  const auto list = parse_number_list(text);
  const bool all = list && std::ranges::all_of(*list, [](const ConfigValue& value) {
                     return is_of(value, Number{});
                   });
  if (!all || std::ranges::find(counts, list->size()) == counts.end())
    throw CLI::ValidationError(
        name, fmt::format("expected {} {}{}, such as 1,2,3, found {}", fmt::join(counts, " or "),
                          noun_of(Number{}), counts.back() == 1 ? "" : "s", text));
  std::vector<Number> numbers(list->size());
  for (std::size_t i = 0; i < numbers.size(); ++i) read((*list)[i], numbers[i]);
  return numbers;
}

template <class Number>
CLI::Option* add(CLI::App& command, const std::string& name, std::vector<Number>& numbers,
                 const std::vector<std::size_t>& counts, const std::string& help) {
  return command
      .add_option_function<std::vector<std::string>>(
          name,
          [&numbers, name, counts](const std::vector<std::string>& words) {
            numbers = read_numbers<Number>(name, words, counts);
          },
          help)
      ->expected(1, static_cast<int>(counts.back()))
      ->type_name("X,Y,Z");
}

}  // namespace

CLI::Option* add_numbers(CLI::App& command, const std::string& name, std::vector<double>& numbers,
                         const std::vector<std::size_t>& counts, const std::string& help) {
  return add(command, name, numbers, counts, help);
}

CLI::Option* add_numbers(CLI::App& command, const std::string& name,
                         std::vector<std::int64_t>& numbers, const std::vector<std::size_t>& counts,
                         const std::string& help) {
  return add(command, name, numbers, counts, help);
}

// Where the text is no such number CLI11 would tell of its type's whole range.
CLI::Validator whole_number() {
  return {[](std::string& text) {
            const bool digits = !text.empty() && text.size() < 19 &&
                                text.find_first_not_of("0123456789") == std::string::npos;
            return digits ? std::string() : "expected an integer of at least 0, found " + text;
          },
          ""};
}

}  // namespace voxweld
