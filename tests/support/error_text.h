// What is thrown, as text.
#pragma once

#include <string>

namespace voxweld::testing {

// What the E says that f throws; "accepted" where it throws none.
template <class E, class F>
std::string error_text(F&& f) {
  try {
    f();
  } catch (const E& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace voxweld::testing
