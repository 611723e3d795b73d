// Names of parametrised tests.
#pragma once

#include <cctype>
#include <string>

namespace voxweld::testing {

// What GoogleTest takes in a name: letters, digits and '_' for all the others.
inline std::string test_name(std::string text) {
  for (char& c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return text;
}

}  // namespace voxweld::testing
