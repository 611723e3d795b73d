#include "pipeline/config/number_list.h"

#include <algorithm>
#include <vector>

#include "pipeline/config/document.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

using Pieces = std::vector<std::string>;

// At each of the characters, blanks around the pieces left out.
Pieces pieces_at(std::string_view text, std::string_view separators) {
  Pieces pieces;
  for (std::size_t begin = 0, end = 0; end != std::string_view::npos; begin = end + 1) {
    end = text.find_first_of(separators, begin);
    pieces.emplace_back(trim(text.substr(begin, end - begin)));
  }
  return pieces;
}

std::string_view without_brackets(std::string_view text) {
  text = trim(text);
  const bool bracketed = text.size() >= 2 && text.front() == '[' && text.back() == ']';
  return bracketed ? trim(text.substr(1, text.size() - 2)) : text;
}

// At commas or, where there are none, at blanks.
Pieces pieces_of(std::string_view text) {
  text = without_brackets(text);
  return text.find(',') != std::string_view::npos ? pieces_at(text, ",") : split_words(text);
}

std::optional<ConfigValue> number_of(const std::string& text) {
  if (const auto whole = parse_integer(text)) return ConfigValue{*whole};
  if (const auto real = parse_real(text)) return ConfigValue{*real};
  return std::nullopt;
}

std::optional<ConfigValue::List> numbers_in(const Pieces& pieces) {
  ConfigValue::List list;
  for (const std::string& piece : pieces) {
    auto number = number_of(piece);
    if (!number) return std::nullopt;
    list.push_back(std::move(*number));
  }
  return list.empty() ? std::nullopt : std::optional(std::move(list));
}

// Labels and ranges of them: what is no number is left for their rule to judge.
std::optional<ConfigValue::List> labels_in(const std::string& text) {
  const Pieces pieces = pieces_of(text);
  if (pieces.size() < 2) return std::nullopt;
  ConfigValue::List list;
  for (const std::string& piece : pieces)
    list.push_back(number_of(piece).value_or(ConfigValue{piece}));
  return list;
}

bool takes_numbers(const Rule& rule) {
  return std::holds_alternative<SpacingRule>(rule) ||
         std::holds_alternative<IntegerListRule>(rule) || std::holds_alternative<TripleRule>(rule);
}

bool takes_real(const Rule& rule) {
  return std::holds_alternative<PositiveNumberRule>(rule) ||
         std::holds_alternative<PartRule>(rule) || std::holds_alternative<NumberRule>(rule) ||
         std::holds_alternative<NumberOrWordRule>(rule);
}

// TOML wants digits on both sides of the point.
std::optional<double> short_real(std::string_view text) {
  return text.find('.') != std::string_view::npos ? parse_real(text) : std::nullopt;
}

}  // namespace

std::optional<ConfigValue::List> parse_number_list(const std::string& text) {
  if (auto list = numbers_in(pieces_of(text))) return list;
  return numbers_in(pieces_at(without_brackets(text), "xX"));
}

std::optional<ConfigValue> typed_value(const Rule& rule, const std::string& text) {
  std::optional<ConfigValue> value = parse_override_value(text);
  // Paths and names that look like numbers or dates are paths and names all the same.
  if (takes_any_text(rule))
    return value && value->text() == nullptr ? ConfigValue{text} : std::move(value);
  if (value && value->text() == nullptr) return value;
  if (const auto real = short_real(text); real && takes_real(rule)) return ConfigValue{*real};
  const std::string written = value ? *value->text() : text;
  std::optional<ConfigValue::List> list;
  if (takes_numbers(rule)) list = parse_number_list(written);
  if (std::holds_alternative<LabelListRule>(rule)) list = labels_in(written);
  if (list) return ConfigValue{std::move(*list)};
  return value;
}

}  // namespace voxweld
