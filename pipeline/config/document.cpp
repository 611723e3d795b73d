#include "pipeline/config/document.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <sstream>

#include "storage/support/error.h"

namespace voxweld {
namespace {

TextPlace place(const toml::source_region& region) {
  return {region.begin.line, region.begin.column};
}

ConfigValue convert(const toml::node& node) {
  if (const auto* flag = node.as_boolean()) return {flag->get()};
  if (const auto* whole = node.as_integer()) return {whole->get()};
  if (const auto* real = node.as_floating_point()) return {real->get()};
  if (const auto* text = node.as_string()) return {text->get()};
  if (const auto* array = node.as_array()) {
    ConfigValue::List list;
    for (const toml::node& item : *array) list.push_back(convert(item));
    return {std::move(list)};
  }
  if (node.is_table()) return {UnusableValue{"a table"}};
  return {UnusableValue{node.is_time() ? "a time" : "a date"}};
}

void add_table(const std::string& table, const toml::table& content,
               std::vector<DocumentEntry>& entries) {
  for (const auto& [key, node] : content)
    entries.push_back(
        {table, std::string(key.str()), convert(node), place(key.source()), place(node.source())});
}

}  // namespace

std::vector<DocumentEntry> parse_document(const std::string& text, const std::string& name) {
  std::vector<DocumentEntry> entries;
  try {
    const toml::table root = toml::parse(text);
    for (const auto& [key, node] : root) {
      if (const auto* table = node.as_table()) {
        entries.push_back({std::string(key.str()),
                           {},
                           {UnusableValue{"a table"}},
                           place(key.source()),
                           place(node.source())});
        add_table(std::string(key.str()), *table, entries);
      } else {
        entries.push_back(
            {{}, std::string(key.str()), convert(node), place(key.source()), place(node.source())});
      }
    }
  } catch (const toml::parse_error& error) {
    const TextPlace at = place(error.source());
    throw InputError(fmt::format(
        "{}:{}:{}: not valid TOML: {}; strings are written in \"quotes\", lists in [brackets]",
        name, at.line, at.column, error.description()));
  }
  // The parser orders by name; errors are reported in the order a reader meets them.
  std::stable_sort(entries.begin(), entries.end(),
                   [](const auto& a, const auto& b) { return a.key_at < b.key_at; });
  return entries;
}

std::optional<ConfigValue> parse_override_value(const std::string& text) {
  try {
    const toml::table root = toml::parse("value = " + text);
    const toml::node* node = root.get("value");
    // A line break could smuggle in further keys.
    if (root.size() == 1 && node != nullptr) return convert(*node);
  } catch (const toml::parse_error&) {
  }
  if (!text.empty() && std::string("\"'[{").find(text.front()) != std::string::npos)
    return std::nullopt;
  return ConfigValue{text};
}

}  // namespace voxweld
