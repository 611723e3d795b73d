// Small configs for the tests: one key to a line, so that places are easy to say.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/config/config.h"
#include "storage/support/error.h"

namespace voxweld::testing {

inline const std::filesystem::path config_path = "/data/scan.toml";

// The least a config must say, in two lines, then `more`.
inline std::string least_config(const std::string& more = {}) {
  return "input.path = \"scan.nrrd\"\nsurface.isovalue = 5\n" + more;
}

inline Config parse(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parse_config(text, config_path, overrides);
}

// The message of the InputError the text must give.
inline std::string error_of(const std::string& text,
                            const std::vector<std::string>& overrides = {}) {
  try {
    parse(text, overrides);
  } catch (const InputError& error) {
    EXPECT_EQ(error.exit_code(), 2);
    return error.what();
  }
  ADD_FAILURE() << "accepted:\n" << text;
  return {};
}

}  // namespace voxweld::testing
