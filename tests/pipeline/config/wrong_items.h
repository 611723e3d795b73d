// Wrong values in tables that may stand any number of times.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/pipeline/config/config_texts.h"
#include "tests/pipeline/config/wrong_values.h"

namespace voxweld::testing {

struct ItemTable {
  std::string table;     // "edit"
  std::string kind_key;  // "shape"
  std::string first;     // a sound one, which the wrong one follows
  int line = 0;          // of the wrong one's first key
};

// Each value of each key, named "KIND KEY", is refused: the message names the place, the item, the
// key, what is accepted and what was found.
inline void expect_values_refused(const std::vector<WrongKey>& keys, const ItemTable& items) {
  for (const WrongKey& wrong_key : keys) {
    const std::string kind = split(wrong_key.name, " ")[0];
    const std::string key = split(wrong_key.name, " ")[1];
    for (const WrongValue& wrong : wrong_key.values) {
      std::string text =
          fmt::format("{}[[{}]]\n{} = {}\n", items.first, items.table, key, wrong.value);
      if (key != items.kind_key)
        text.append(items.kind_key).append(" = ").append(toml_string(kind)).append("\n");
      EXPECT_EQ(error_of(least_config(text)),
                fmt::format("/data/scan.toml:{}:{}: {} 2: {}: expected {}, found {}", items.line,
                            key.size() + 4, items.table, key, wrong_key.expected, wrong.found));
    }
  }
}

}  // namespace voxweld::testing
