#include "pipeline/config/config_value.h"

#include <fmt/format.h>

#include <cmath>

#include "pipeline/config/overloaded.h"

namespace voxweld {
namespace {

std::string real_toml(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  std::string text = fmt::format("{}", value);  // shortest text that reads back as the same bits
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string list_toml(const ConfigValue::List& list) {
  std::string text = "[";
  for (const ConfigValue& item : list) text += (text.size() > 1 ? ", " : "") + to_toml(item);
  return text + "]";
}

// Cuts between UTF-8 characters.
std::string_view cut(std::string_view text, std::size_t limit) {
  if (text.size() <= limit) return text;
  while (limit > 0 && (static_cast<unsigned char>(text[limit]) & 0xc0) == 0x80) --limit;
  return text.substr(0, limit);
}

constexpr std::size_t longest_shown = 80;

}  // namespace

bool ConfigValue::is_number() const {
  return std::holds_alternative<std::int64_t>(data) || std::holds_alternative<double>(data);
}

double ConfigValue::number() const {
  if (const auto* whole = integer()) return static_cast<double>(*whole);
  return std::get<double>(data) + 0.0;
}

std::string toml_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += fmt::format("\\{}", c);
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    else
      out += c;
  }
  return out + "\"";
}

std::string toml_string_short(std::string_view text, std::size_t limit) {
  const std::string_view head = cut(text, limit);
  return head.size() == text.size() ? toml_string(text) : toml_string(std::string(head) + "...");
}

std::string to_toml(const ConfigValue& value) {
  return std::visit(Overloaded{[](bool v) { return std::string(v ? "true" : "false"); },
                               [](std::int64_t v) { return std::to_string(v); },
                               [](double v) { return real_toml(v); },
                               [](const std::string& v) { return toml_string(v); },
                               [](const ConfigValue::List& v) { return list_toml(v); },
                               [](const UnusableValue& v) { return v.kind; }},
                    value.data);
}

std::string describe(const ConfigValue& value) {
  if (const auto* text = value.text()) return toml_string_short(*text) + " (a string)";
  if (const auto* other = std::get_if<UnusableValue>(&value.data)) return other->kind;
  std::string text = to_toml(value);
  if (text.size() > longest_shown) text = std::string(cut(text, longest_shown)) + "...";
  if (value.flag() != nullptr) return text + " (a boolean)";
  if (const auto* list = value.list()) return text + fmt::format(" (a list of {})", list->size());
  return text;
}

void feed(KeyHasher& hasher, const ConfigValue& value) {
  hasher.integer(static_cast<std::int64_t>(value.data.index()));
  if (const auto* list = value.list()) {
    hasher.integer(static_cast<std::int64_t>(list->size()));
    for (const ConfigValue& item : *list) feed(hasher, item);
  } else if (const auto* whole = value.integer()) {
    hasher.integer(*whole);
  } else if (value.is_number()) {
    hasher.real(value.number());
  } else if (const auto* text = value.text()) {
    hasher.text(*text);
  } else if (const auto* flag = value.flag()) {
    hasher.integer(*flag ? 1 : 0);
  }
}

}  // namespace voxweld
