// A value as the config file holds it, before it is given its meaning.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "storage/support/hash.h"

namespace voxweld {

// What no setting takes: dates, times, tables. `kind` is what to call it in a message.
struct UnusableValue {
  std::string kind;
  friend bool operator==(const UnusableValue&, const UnusableValue&) = default;
};

struct ConfigValue {
  using List = std::vector<ConfigValue>;
  std::variant<bool, std::int64_t, double, std::string, List, UnusableValue> data;

  const bool* flag() const { return std::get_if<bool>(&data); }
  const std::int64_t* integer() const { return std::get_if<std::int64_t>(&data); }
  const std::string* text() const { return std::get_if<std::string>(&data); }
  const List* list() const { return std::get_if<List>(&data); }
  bool is_number() const;
  double number()
      const;  // precondition: is_number(); -0 becomes 0, so that equal values hash alike

  friend bool operator==(const ConfigValue&, const ConfigValue&) = default;
};

// TOML: 0.1, "text", [1, 2]. Precondition: no UnusableValue inside.
std::string to_toml(const ConfigValue& value);

// For messages: the value as TOML and what it is, in one line of bounded length.
std::string describe(const ConfigValue& value);

// A TOML basic string, control characters escaped; longer texts than `limit` bytes are cut.
std::string toml_string(std::string_view text);
std::string toml_string_short(std::string_view text, std::size_t limit = 60);

// Feeds the value with its type, so that no two values feed the same bytes.
void feed(KeyHasher& hasher, const ConfigValue& value);

}  // namespace voxweld
