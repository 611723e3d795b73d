// Info documents for the terminal: one line a key, objects indented, lists of objects as tables.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "pipeline/executor/memory_budget.h"
#include "pipeline/info/info.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

bool ends_with_bytes(const std::string& key) {
  return key == "bytes" || key.ends_with("_bytes");
}

// Sizes read better with crosses than in brackets.
bool is_extent(const std::string& key) {
  return key == "size" || key == "spacing" || key == "chunk" || key == "file";
}

std::string scalar(const std::string& key, const InfoDocument& value) {
  if (value.is_null()) return "none";
  if (value.is_string()) return value.get<std::string>().empty() ? "none" : value;
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  if (ends_with_bytes(key))
    return fmt::format("{} ({})", json_text(value), readable_bytes(value.get<double>()));
  return json_text(value);
}

std::string list(const std::string& key, const InfoDocument& values) {
  std::string text;
  for (const InfoDocument& value : values) {
    const bool nested = value.is_array();
    if (!text.empty()) text += is_extent(key) && !nested ? " x " : ", ";
    text += nested ? fmt::format("({})", list("", value)) : scalar("", value);
  }
  return text.empty() ? "none" : text;
}

std::string label(std::string key) {
  std::ranges::replace(key, '_', ' ');
  return key;
}

std::string table(const InfoDocument& rows, const std::string& indent) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : rows.front().items()) keys.push_back(key);
  std::vector<std::vector<std::string>> cells = {{}};
  for (const std::string& key : keys) cells[0].push_back(label(key));
  for (const InfoDocument& row : rows) {
    cells.emplace_back();
    for (const std::string& key : keys) {
      const InfoDocument value = row.value(key, InfoDocument());
      cells.back().push_back(value.is_array() ? list("", value) : scalar("", value));
    }
  }
  std::string text;
  for (const auto& row : cells) {
    std::string line = indent;
    for (std::size_t column = 0; column < keys.size(); ++column) {
      std::size_t width = 0;
      for (const auto& other : cells) width = std::max(width, other[column].size());
      line += fmt::format("{:<{}}", row[column], column + 1 < keys.size() ? width + 2 : 0);
    }
    text += line + "\n";
  }
  return text;
}

std::string object(const InfoDocument& document, const std::string& indent) {
  std::size_t width = 0;
  for (const auto& [key, value] : document.items()) width = std::max(width, key.size());
  std::string text;
  for (const auto& [key, value] : document.items()) {
    const bool rows = value.is_array() && !value.empty() && value.front().is_object();
    if (rows || (value.is_object() && !value.empty())) {
      text += fmt::format("{}{}:\n", indent, label(key));
      text += rows ? table(value, indent + "  ") : object(value, indent + "  ");
    } else {
      text += fmt::format("{}{:<{}}{}\n", indent, label(key), width + 2,
                          value.is_array()    ? list(key, value)
                          : value.is_object() ? "none"
                                              : scalar(key, value));
    }
  }
  return text;
}

}  // namespace

std::string to_text(const InfoDocument& document) {
  return object(document, "");
}

std::string to_json_text(const InfoDocument& document) {
  return json_text(document, 2) + "\n";
}

}  // namespace voxweld
