// Tables of wrong values, written as text: lines "KEY: EXPECTED", then, indented, what the keys are
// given and the message says it found, with " | " between one and the next. The value as TOML is
// what stands before " (a " or ";"; where the message shows it in another way: "VALUE => FOUND".
// A line that ends in a backslash goes on in the next.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace voxweld::testing {

struct WrongValue {
  std::string value;  // as TOML
  std::string found;  // what follows "found " in the message
};

struct WrongKey {
  std::string name;
  std::string expected;  // what follows "expected " in the message
  std::vector<WrongValue> values;
};

inline std::vector<std::string> split(const std::string& text, const std::string& separator) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(separator, at), text.size());
    parts.push_back(text.substr(at, end - at));
    at = end + separator.size();
  }
  return parts;
}

inline WrongValue wrong_value(const std::string& cell) {
  const std::size_t arrow = cell.find(" => ");
  if (arrow != std::string::npos) return {cell.substr(0, arrow), cell.substr(arrow + 4)};
  return {cell.substr(0, std::min(cell.find(" (a "), cell.find(';'))), cell};
}

inline std::vector<WrongKey> read_wrong_keys(std::string table) {
  for (std::size_t at; (at = table.find("\\\n")) != std::string::npos;) table.erase(at, 2);
  std::vector<WrongKey> keys;
  std::size_t named = 0;  // keys before the ones whose values are being read
  bool reading_values = true;
  for (const std::string& line : split(table, "\n")) {
    if (line.empty()) continue;
    if (!line.starts_with("  ")) {
      const std::size_t colon = line.find(": ");
      if (colon == std::string::npos) throw std::runtime_error("no key: " + line);
      if (reading_values) named = keys.size();
      keys.push_back({line.substr(0, colon), line.substr(colon + 2), {}});
    } else {
      for (const std::string& cell : split(line.substr(2), " | "))
        for (std::size_t i = named; i < keys.size(); ++i)
          keys[i].values.push_back(wrong_value(cell));
    }
    reading_values = line.starts_with("  ");
  }
  return keys;
}

}  // namespace voxweld::testing
