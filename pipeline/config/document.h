// A TOML text taken apart into tables, keys and values with their places; nothing is known of
// settings here.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/config/config_value.h"

namespace voxweld {

struct TextPlace {
  std::uint32_t line = 0, column = 0;  // from 1
  friend auto operator<=>(const TextPlace&, const TextPlace&) = default;
};

struct DocumentEntry {
  std::string table;  // empty: outside any table
  std::string key;    // empty: the entry is the table itself
  ConfigValue value;  // for tables: an UnusableValue
  TextPlace key_at, value_at;
  std::size_t item = 0;  // which of the tables [[table]], from 1; 0: there is one, [table]
  TextPlace value_end;   // behind the value's last character; of tables unspecified
};

// The byte of the text that is there. Columns count characters, a byte order mark is none.
// Precondition: the place is one of the text's.
std::size_t offset_of(const std::string& text, TextPlace at);

// "scan.toml:3:14"
std::string place_text(const std::string& name, TextPlace at);

// Every table and every key of the text in the order they stand in it. A table inside a table is a
// key whose value is an UnusableValue.
// Throws InputError "<name>:line:column: ..." where the text is not TOML.
std::vector<DocumentEntry> parse_document(const std::string& text, const std::string& name);

// The value of an override: TOML, else a bare word, taken as a string. Empty where it is meant as
// TOML (it begins with a quote or a bracket) and is not.
std::optional<ConfigValue> parse_override_value(const std::string& text);

}  // namespace voxweld
