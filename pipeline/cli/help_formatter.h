// How --help lays out a command: in lines of at most 80 characters.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace voxweld {

class HelpFormatter : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override;
};

}  // namespace voxweld
