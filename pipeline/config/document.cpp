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

TextPlace place_behind(const toml::node& node) {
  return {node.source().end.line, node.source().end.column};
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

using Entries = std::vector<DocumentEntry>;

// The table itself stands where its key does, or its header.
void add_table(const std::string& name, const toml::table& content, TextPlace key_at,
               std::size_t item, Entries& entries) {
  entries.push_back(
      {name, {}, {UnusableValue{"a table"}}, key_at, place(content.source()), item, {}});
  for (const auto& [key, node] : content)
    entries.push_back({name, std::string(key.str()), convert(node), place(key.source()),
                       place(node.source()), item, place_behind(node)});
}

void add_root_key(const toml::key& key, const toml::node& node, Entries& entries) {
  const std::string name(key.str());
  if (const auto* table = node.as_table())
    return add_table(name, *table, place(key.source()), 0, entries);
  if (!node.is_array_of_tables()) {
    entries.push_back({{},
                       name,
                       convert(node),
                       place(key.source()),
                       place(node.source()),
                       0,
                       place_behind(node)});
    return;
  }
  std::size_t item = 0;
  for (const toml::node& table : *node.as_array())
    add_table(name, *table.as_table(), place(table.source()), ++item, entries);
}

}  // namespace

std::size_t offset_of(const std::string& text, TextPlace at) {
  std::size_t offset = text.starts_with("\xef\xbb\xbf") ? 3 : 0;
  for (std::uint32_t line = 1; line < at.line; ++line) offset = text.find('\n', offset) + 1;
  const auto continues = [&](std::size_t i) {  // a character of UTF-8
    return i < text.size() && (static_cast<unsigned char>(text[i]) & 0xc0) == 0x80;
  };
  for (std::uint32_t column = 1; column < at.column && offset < text.size(); ++column) do
      ++offset;
    while (continues(offset));
  return offset;
}

std::string place_text(const std::string& name, TextPlace at) {
  return fmt::format("{}:{}:{}", name, at.line, at.column);
}

std::vector<DocumentEntry> parse_document(const std::string& text, const std::string& name) {
  Entries entries;
  try {
    const toml::table root = toml::parse(text);
    for (const auto& [key, node] : root) add_root_key(key, node, entries);
  } catch (const toml::parse_error& error) {
    const TextPlace at = place(error.source());
    throw InputError(fmt::format(
        "{}: not valid TOML: {}; strings are written in \"quotes\", lists in [brackets]",
        place_text(name, at), error.description()));
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
