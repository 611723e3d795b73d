#include "pipeline/config/rule.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include "pipeline/config/label_list.h"
#include "pipeline/config/overloaded.h"
#include "pipeline/config/suggest.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

Verdict refuse(std::string hint = {}) {
  return {false, std::move(hint)};
}

// A number in quotes, or a word without: the two slips of TOML's syntax worth a hint.
std::string quote_hint(const ConfigValue& value) {
  const std::string* text = value.text();
  if (text == nullptr || text->empty()) return {};
  if (*text == "true" || *text == "false") return "write " + *text + " without quotes";
  double parsed = 0;
  const char* const end = text->data() + text->size();
  const auto [stop, error] = std::from_chars(text->data(), end, parsed);
  return error == std::errc{} && stop == end ? "write numbers without quotes" : "";
}

std::string meant(const std::string& name, const std::vector<std::string>& names) {
  const std::string nearest = nearest_name(lower(name), names);
  return nearest.empty() ? "" : "did you mean " + toml_string(nearest) + "?";
}

Verdict check_choice(const std::vector<std::string>& names, const ConfigValue& value) {
  const std::string* text = value.text();
  if (text == nullptr) return refuse();
  if (contains(names, *text)) return {true, {}};
  return refuse(meant(*text, names));
}

Verdict check_choices(const std::vector<std::string>& names, const ConfigValue& value) {
  const auto* list = value.list();
  if (list == nullptr && value.text() != nullptr && contains(names, *value.text()))
    return refuse("write it in brackets: [" + toml_string(*value.text()) + "]");
  if (list == nullptr || list->empty()) return refuse();
  for (auto item = list->begin(); item != list->end(); ++item) {
    if (Verdict one = check_choice(names, *item); !one.accepted) return one;
    if (std::find(list->begin(), item, *item) != item)
      return refuse(*item->text() + " is listed twice");
  }
  return {true, {}};
}

Verdict check_integer(std::int64_t lo, std::int64_t hi, const ConfigValue& value) {
  const auto* whole = value.integer();
  if (whole == nullptr) return refuse(quote_hint(value));
  return {*whole >= lo && *whole <= hi, {}};
}

bool is_auto(const ConfigValue& value) {
  return value.text() != nullptr && *value.text() == "auto";
}

Verdict check_power(const PowerOfTwoRule& rule, const ConfigValue& value) {
  Verdict verdict = check_integer(rule.lo, rule.hi, value);
  if (!verdict.accepted) return verdict;
  const auto whole = static_cast<std::uint64_t>(*value.integer());
  if (std::has_single_bit(whole)) return verdict;
  return refuse(
      fmt::format("the nearest are {} and {}", std::bit_floor(whole), std::bit_ceil(whole)));
}

// Integers that a double cannot hold exactly are refused, not rounded.
bool exact_number(const ConfigValue& value) {
  constexpr std::int64_t limit = std::int64_t{1} << 53;
  if (const auto* whole = value.integer()) return *whole >= -limit && *whole <= limit;
  return value.is_number() && std::isfinite(value.number());
}

Verdict check_positive(const ConfigValue& value) {
  if (!value.is_number()) return refuse(quote_hint(value));
  return {exact_number(value) && value.number() > 0, {}};
}

Verdict check_part(const ConfigValue& value) {
  const Verdict positive = check_positive(value);
  return positive.accepted ? Verdict{value.number() <= 1, {}} : positive;
}

// A list of `count` items that all fit.
template <class F>
bool is_list_of(const ConfigValue& value, std::size_t count, F&& fits) {
  const auto* list = value.list();
  return list != nullptr && list->size() == count && std::ranges::all_of(*list, fits);
}

Verdict check_number_or_word(const NumberOrWordRule& rule, const ConfigValue& value) {
  if (value.text() != nullptr && contains(rule.words, *value.text())) return {true, {}};
  if (large_integer_of(value)) return {true, {}};
  if (value.text() == nullptr) return {value.is_number() && std::isfinite(value.number()), {}};
  const std::string hint = quote_hint(value);
  return refuse(hint.empty() ? meant(*value.text(), rule.words) : hint);
}

Verdict check_numbers_or_words(const NumberOrWordRule& rule, const ConfigValue& value) {
  const auto* list = value.list();
  if (list == nullptr) return check_number_or_word(rule, value);
  if (list->empty()) return refuse();
  for (auto item = list->begin(); item != list->end(); ++item) {
    if (Verdict one = check_number_or_word(rule, *item); !one.accepted) return one;
    const auto same = [&](const ConfigValue& other) {
      return other.is_number() && item->is_number() ? other.number() == item->number()
                                                    : other == *item;
    };
    if (std::any_of(list->begin(), item, same)) return refuse(to_toml(*item) + " is listed twice");
  }
  return {true, {}};
}

Verdict check_spacing(const ConfigValue& value) {
  if (value.list() == nullptr) return check_positive(value);
  return {is_list_of(value, 3, [](const auto& item) { return check_positive(item).accepted; }), {}};
}

Verdict check_integers(const IntegerListRule& rule, const ConfigValue& value) {
  return {
      is_list_of(value, rule.count,
                 [&](const auto& item) { return check_integer(rule.lo, rule.hi, item).accepted; }),
      {}};
}

Verdict check_triple(const TripleRule& rule, const ConfigValue& value) {
  using Of = TripleRule::Of;
  const auto fits = [&](const ConfigValue& item) {
    return exact_number(item) && (rule.of != Of::positive || item.number() > 0);
  };
  const auto zero = [](const ConfigValue& item) { return item.number() == 0; };
  return {
      is_list_of(value, 3, fits) && !(rule.of == Of::not_all_zero && is_list_of(value, 3, zero)),
      {}};
}

Verdict check_number(const ConfigValue& value) {
  return exact_number(value) ? Verdict{true, {}} : refuse(quote_hint(value));
}

Verdict check_pair(const NumberPairRule& rule, const ConfigValue& value) {
  if (!is_list_of(value, 2, exact_number)) return refuse();
  const double first = value.list()->front().number(), second = value.list()->back().number();
  // A straight line is drawn between the two.
  if (!std::isfinite(second - first)) return refuse("they are too far apart");
  return {rule.of == NumberPairRule::Of::ascending ? first < second : first != second, {}};
}

Verdict check_per_axis(const PerAxisRule& rule, const ConfigValue& value) {
  const auto least = static_cast<double>(rule.least), most = static_cast<double>(rule.most);
  const auto fits = [&](const ConfigValue& item) {
    if (rule.whole && item.integer() == nullptr) return false;
    return item.is_number() && item.number() >= least && item.number() <= most;
  };
  const auto idle = [&](const ConfigValue& item) { return item.number() == least; };
  if (value.list() == nullptr)
    return fits(value) && !idle(value) ? Verdict{true, {}} : refuse(quote_hint(value));
  return {is_list_of(value, 3, fits) && !is_list_of(value, 3, idle), {}};
}

Verdict check_axes(const ConfigValue& value) {
  const std::string* text = value.text();
  if (text == nullptr || text->empty()) return refuse();
  for (const char letter : *text) {
    if (letter < 'x' || letter > 'z') return refuse();
    if (std::ranges::count(*text, letter) > 1)
      return refuse(fmt::format("{} is listed twice", letter));
  }
  return {true, {}};
}

Verdict check_memory(const MemoryRule& rule, const ConfigValue& value) {
  if (rule.automatic && is_auto(value)) return {true, {}};
  if (const auto* whole = value.integer())
    return {*whole >= 0 && static_cast<std::uint64_t>(*whole) >= rule.least, {}};
  if (value.text() == nullptr) return refuse();
  const auto bytes = parse_bytes(*value.text());
  if (!bytes) return refuse("units are B, KiB, MiB, GiB, TiB, KB, MB, GB and TB");
  return {*bytes >= rule.least, {}};
}

bool has_control(const std::string& text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

Verdict check_path(const ConfigValue& value) {
  const std::string* text = value.text();
  if (text == nullptr) return refuse("write paths in quotes");
  if (has_control(*text)) return refuse("it holds a control character; write backslashes twice");
  return {!text->empty(), {}};
}

Verdict check_name(const ConfigValue& value) {
  const std::string* text = value.text();
  if (text == nullptr) return refuse("write names in quotes");
  return {!has_control(*text) && text->find_first_of(" \"'\\#") == std::string::npos, {}};
}

Verdict check_text(const ConfigValue& value) {
  const std::string* text = value.text();
  if (text == nullptr) return refuse("write it in quotes");
  return {!text->empty() && !has_control(*text), {}};
}

// Parts of digits: minutes, m:s or h:m:s; after "days-" hours, h:m or h:m:s.
bool is_time_limit(const std::string& text) {
  constexpr std::size_t longest_part = 9;
  int dashes = 0;
  int colons = 0;
  std::size_t digits = 0;
  for (const char c : text) {
    if (c >= '0' && c <= '9') {
      if (++digits > longest_part) return false;
      continue;
    }
    const bool dash = c == '-' && dashes == 0 && colons == 0;
    if (digits == 0 || !(dash || c == ':')) return false;
    (dash ? dashes : colons) += 1;
    digits = 0;
  }
  return digits > 0 && colons <= 2;
}

Verdict check_time_limit(const ConfigValue& value) {
  const std::string* text = value.text();
  if (text == nullptr) return refuse("write it in quotes");
  return {is_time_limit(*text), {}};
}

// The name of the option: "--array" of "--array=1-3", "-a" of "-a1-3".
std::string option_name(const std::string& option) {
  if (option.starts_with("--")) return option.substr(0, option.find_first_of("= "));
  return option.substr(0, 2);
}

Verdict check_options(const std::vector<std::string>& reserved, const ConfigValue& value) {
  const auto* list = value.list();
  if (list == nullptr) return refuse(value.text() == nullptr ? "" : "write it in brackets");
  for (const ConfigValue& item : *list) {
    const std::string* text = item.text();
    if (text == nullptr || text->size() < 2 || text->front() != '-' || has_control(*text))
      return refuse();
    const std::string name = option_name(*text);
    // sbatch takes any prefix of a long option that is one option's only.
    for (const std::string& one : reserved)
      if (one == name || (name.size() > 3 && name.starts_with("--") && one.starts_with(name)))
        return refuse(one + " is set by voxweld itself");
  }
  return {true, {}};
}

Verdict check_lines(const ConfigValue& value) {
  const auto* list = value.list();
  if (list == nullptr) return refuse(value.text() == nullptr ? "" : "write it in brackets");
  return {std::all_of(list->begin(), list->end(),
                      [](const ConfigValue& item) {
                        return item.text() != nullptr && !has_control(*item.text());
                      }),
          {}};
}

struct Unit {
  const char* name;
  std::uint64_t bytes;
};
constexpr std::array<Unit, 9> units = {{{"tib", std::uint64_t{1} << 40},
                                        {"gib", std::uint64_t{1} << 30},
                                        {"mib", std::uint64_t{1} << 20},
                                        {"kib", std::uint64_t{1} << 10},
                                        {"tb", 1000000000000},
                                        {"gb", 1000000000},
                                        {"mb", 1000000},
                                        {"kb", 1000},
                                        {"b", 1}}};

}  // namespace

bool takes_any_text(const Rule& rule) {
  return std::holds_alternative<PathRule>(rule) || std::holds_alternative<NameRule>(rule) ||
         std::holds_alternative<TextRule>(rule) || std::holds_alternative<TimeLimitRule>(rule);
}

Verdict check(const Rule& rule, const ConfigValue& value) {
  return std::visit(
      Overloaded{[&](const PathRule&) { return check_path(value); },
                 [&](const ChoiceRule& r) { return check_choice(r.names, value); },
                 [&](const ChoiceListRule& r) { return check_choices(r.names, value); },
                 [&](const FlagRule&) {
                   return Verdict{value.flag() != nullptr, quote_hint(value)};
                 },
                 [&](const SwitchRule&) {
                   return Verdict{is_auto(value) || value.flag() != nullptr, quote_hint(value)};
                 },
                 [&](const IntegerRule& r) {
                   if (r.automatic && is_auto(value)) return Verdict{true, {}};
                   return check_integer(r.lo, r.hi, value);
                 },
                 [&](const PowerOfTwoRule& r) { return check_power(r, value); },
                 [&](const PositiveNumberRule&) { return check_positive(value); },
                 [&](const PartRule&) { return check_part(value); },
                 [&](const NumberOrWordRule& r) { return check_numbers_or_words(r, value); },
                 [&](const SpacingRule&) { return check_spacing(value); },
                 [&](const IntegerListRule& r) { return check_integers(r, value); },
                 [&](const TripleRule& r) { return check_triple(r, value); },
                 [&](const NumberRule&) { return check_number(value); },
                 [&](const NumberPairRule& r) { return check_pair(r, value); },
                 [&](const PerAxisRule& r) { return check_per_axis(r, value); },
                 [&](const AxesRule&) { return check_axes(value); },
                 [&](const MemoryRule& r) { return check_memory(r, value); },
                 [&](const NameRule&) { return check_name(value); },
                 [&](const TextRule&) { return check_text(value); },
                 [&](const TimeLimitRule&) { return check_time_limit(value); },
                 [&](const OptionListRule& r) { return check_options(r.reserved, value); },
                 [&](const LineListRule&) { return check_lines(value); },
                 [&](const LabelRule&) { return check_label(value); },
                 [&](const LabelListRule& r) { return check_label_list(r, value); }},
      rule);
}

std::optional<std::uint64_t> parse_bytes(const std::string& text) {
  double count = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, count, std::chars_format::fixed);
  if (error != std::errc{} || text.front() < '0' || text.front() > '9') return std::nullopt;
  const std::string unit = lower({std::find_if(stop, end, [](char c) { return c != ' '; }), end});
  for (const Unit& known : units) {
    if (unit != known.name) continue;
    // Whole counts are multiplied as integers, so that every byte count has an exact text.
    std::uint64_t whole = 0;
    const auto exact = std::from_chars(text.data(), stop, whole);
    if (exact.ec == std::errc{} && exact.ptr == stop) {
      if (whole > std::uint64_t{std::numeric_limits<std::int64_t>::max()} / known.bytes)
        return std::nullopt;
      return whole * known.bytes;
    }
    const double bytes = count * static_cast<double>(known.bytes);
    if (!(bytes < 0x1p63)) return std::nullopt;
    return static_cast<std::uint64_t>(bytes);
  }
  return std::nullopt;
}

std::string bytes_text(std::uint64_t bytes) {
  constexpr std::array<const char*, 4> names = {"TiB", "GiB", "MiB", "KiB"};
  for (std::size_t i = 0; i < names.size(); ++i)
    if (bytes != 0 && bytes % units[i].bytes == 0)
      return fmt::format("{}{}", bytes / units[i].bytes, names[i]);
  return fmt::format("{}B", bytes);
}

}  // namespace voxweld
