// What values a setting takes. One rule serves the parser, the messages, the help and the schema.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/config/config_value.h"

namespace voxweld {

struct PathRule {};  // not empty; relative ones are made absolute by the loader
struct ChoiceRule {  // one of the names
  std::vector<std::string> names;
};
struct ChoiceListRule {  // at least one of the names, each once
  std::vector<std::string> names;
};
struct FlagRule {};    // true or false
struct SwitchRule {};  // "auto", true or false
struct IntegerRule {   // lo .. hi
  std::int64_t lo = 0, hi = 0;
  bool automatic = false;  // or "auto"
};
struct PowerOfTwoRule {  // lo .. hi
  std::int64_t lo = 1, hi = 1;
};
struct PositiveNumberRule {};  // finite, above 0
struct PartRule {};            // above 0, at most 1
// Finite, or one of the words; integers beyond TOML's 63 bits in quotes. Or a list of such.
struct NumberOrWordRule {
  std::vector<std::string> words;
};
struct SpacingRule {};    // a positive number, or three
struct IntegerListRule {  // exactly `count`, each lo .. hi
  std::size_t count = 0;
  std::int64_t lo = 0, hi = 0;
};
struct TripleRule {  // three finite numbers
  enum class Of : std::uint8_t { any, positive, not_all_zero } of = Of::any;
};
struct NumberRule {};    // finite
struct NumberPairRule {  // two finite numbers
  enum class Of : std::uint8_t { ascending, apart } of = Of::ascending;
};
// A number for all axes or three, each least .. most, not all of them the least, which does nothing.
struct PerAxisRule {
  std::int64_t least = 0, most = 0;
  bool whole = false;  // integers
};
struct AxesRule {};  // letters x, y and z, at least one, each once
struct MemoryRule {  // bytes, or text such as "4GiB"
  std::uint64_t least = 0;
  bool automatic = false;  // or "auto"
};
struct NameRule {};                   // one word; empty for a default that is not ours
struct TextRule {};                   // one line, not empty
struct TimeLimitRule {};              // as `sbatch --time` takes it: "90", "4:00:00", "1-12"
struct OptionListRule {               // options of a program, each beginning with "-" on one line
  std::vector<std::string> reserved;  // those the user may not give: "--array", "-a"
};
struct LineListRule {};  // texts of one line each
struct LabelRule {};     // an integer of 64 bits, in quotes beyond TOML's 63
struct LabelListRule {   // one of the words, or a list of labels and ranges of them
  std::vector<std::string> words;
  bool may_be_empty = false;  // the list
};

using Rule = std::variant<PathRule, ChoiceRule, ChoiceListRule, FlagRule, SwitchRule, IntegerRule,
                          PowerOfTwoRule, PositiveNumberRule, PartRule, NumberOrWordRule,
                          SpacingRule, IntegerListRule, TripleRule, NumberRule, NumberPairRule,
                          PerAxisRule, AxesRule, MemoryRule, NameRule, TextRule, TimeLimitRule,
                          OptionListRule, LineListRule, LabelRule, LabelListRule>;

// Whether the rule takes one text and nothing else, so that on a command line quotes say nothing.
// Choices are left out: a number in the place of a name is worth a message.
bool takes_any_text(const Rule& rule);

// Reads after "expected": "a power of two from 8 to 256".
std::string accepted_text(const Rule& rule);

// Whether the value may be taken; when not, `hint` may say what was probably meant.
struct Verdict {
  bool accepted = false;
  std::string hint;  // "", or a clause such as: did you mean "above"?
};
Verdict check(const Rule& rule, const ConfigValue& value);

// Bytes of "4GiB", "500 MB", "1.5TiB" (KiB .. TiB: powers of 1024; KB .. TB: of 1000; B), in any
// letter case; empty when it is not such a text or does not fit 63 bits.
std::optional<std::uint64_t> parse_bytes(const std::string& text);
// The shortest exact text: "4GiB", "1500MiB", "1000B". parse_bytes reads it back.
std::string bytes_text(std::uint64_t bytes);

}  // namespace voxweld
