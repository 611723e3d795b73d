#include <fmt/format.h>

#include <array>
#include <limits>

#include "pipeline/config/overloaded.h"
#include "pipeline/config/rule.h"

namespace voxweld {
namespace {

std::string alternatives(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + toml_string(names[i]);
  return text;
}

std::string range_text(std::int64_t lo, std::int64_t hi) {
  if (hi == std::numeric_limits<std::int64_t>::max()) return fmt::format("of at least {}", lo);
  return fmt::format("from {} to {}", lo, hi);
}

}  // namespace

std::string accepted_text(const Rule& rule) {
  using fmt::format;
  return std::visit(
      Overloaded{
          [](const PathRule&) { return std::string("a path in quotes"); },
          [](const ChoiceRule& r) { return alternatives(r.names); },
          [](const ChoiceListRule& r) {
            return "a list of one or more of " + alternatives(r.names) + ", each once";
          },
          [](const FlagRule&) { return std::string("true or false"); },
          [](const SwitchRule&) { return std::string("\"auto\", true or false"); },
          [](const IntegerRule& r) {
            return (r.automatic ? "\"auto\" or an integer " : "an integer ") +
                   range_text(r.lo, r.hi);
          },
          [](const PowerOfTwoRule& r) { return "a power of two " + range_text(r.lo, r.hi); },
          [](const PositiveNumberRule&) { return std::string("a finite number above 0"); },
          [](const PartRule&) { return std::string("a number above 0, at most 1"); },
          [](const NumberOrWordRule& r) {
            return "a finite number, " + alternatives(r.words) + ", or a list of such";
          },
          [](const SpacingRule&) {
            return std::string("a finite number above 0, or three of them: [x, y, z]");
          },
          [](const IntegerListRule& r) {
            return format("a list of {} integers {}", r.count, range_text(r.lo, r.hi));
          },
          [](const TripleRule& r) {
            constexpr std::array<const char*, 3> kinds = {"", " above 0", ", not all 0"};
            return format("three finite numbers{}: [x, y, z]",
                          kinds[static_cast<std::size_t>(r.of)]);
          },
          [](const NumberRule&) { return std::string("a finite number"); },
          [](const NumberPairRule& r) {
            return std::string(r.of == NumberPairRule::Of::ascending
                                   ? "two finite numbers, the lower first: [lo, hi]"
                                   : "two finite numbers that are not equal: [a, b]");
          },
          [](const PerAxisRule& r) {
            return format("{} above {}, at most {}, or three from {} to {}, not all {}: [x, y, z]",
                          r.whole ? "an integer" : "a number", r.least, r.most, r.least, r.most,
                          r.least);
          },
          [](const AxesRule&) {
            return std::string("the letters of axes, each once: \"x\", \"yz\", \"xyz\"");
          },
          [](const MemoryRule& r) {
            return format("{}text such as \"4GiB\" or a number of bytes, at least {}",
                          r.automatic ? "\"auto\", " : "", bytes_text(r.least));
          },
          [](const NameRule&) {
            return std::string("a name in quotes, without spaces, quotes, \\ and #");
          },
          [](const TextRule&) { return std::string("text in quotes, of one line"); },
          [](const TimeLimitRule&) {
            return std::string(
                "a time in quotes: \"minutes\", \"m:s\", \"h:m:s\", \"days-h\", \"days-h:m\" or "
                "\"days-h:m:s\"");
          },
          [](const OptionListRule&) {
            return std::string("a list of options, each text of one line beginning with -");
          },
          [](const LineListRule&) { return std::string("a list of texts of one line each"); },
          [](const LabelRule&) {
            return format("an integer of at least 0, in quotes above {}",
                          std::numeric_limits<std::int64_t>::max());
          },
          [](const LabelListRule& r) {
            const std::string list = "a list of labels and ranges such as [1, 5, \"10-20\"]";
            std::string words;
            for (const std::string& word : r.words)
              words += (words.empty() ? "" : ", ") + toml_string(word);
            return words.empty() ? list : words + " or " + list;
          }},
      rule);
}

}  // namespace voxweld
