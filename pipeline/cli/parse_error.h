// What to say of a command line that cannot be understood.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace voxweld {

// One line: what is wrong, the nearest name where one was mistyped, and where to read more.
// Precondition: parsing by `app` has thrown `error`.
std::string parse_error_text(const CLI::App& app, const CLI::ParseError& error);

}  // namespace voxweld
