// What there is to say about the command line, read from the CLI's own tree. The help, the manual
// page and the completions are all made from it, so that none of them can go stale.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "pipeline/config/rule.h"

namespace voxweld {

struct OptionText {
  std::vector<std::string> names;  // as they are typed: "-o", "--output"; of an argument "CONFIG"
  bool argument = false;           // goes by its place, not by its name
  bool required = false;
  std::string value;                 // what follows the name: "FILE", "N N N"; empty for a flag
  std::vector<std::string> choices;  // the only words it takes; empty: any
  std::string help;                  // a sentence or more, with the default at the end
  std::string group;                 // its heading

  bool takes_file() const { return value == "FILE"; }
  bool takes_setting() const { return value == "KEY=VALUE"; }
  // "-o, --output FILE"
  std::string title() const;
};

struct CommandText {
  std::string name;                 // "run"; "voxweld" for all of it
  std::string group;                // the heading it stands under
  std::string summary;              // one line
  std::string details;              // more sentences; may be empty
  std::string footer;               // examples, laid out
  std::vector<OptionText> options;  // arguments first
  std::vector<CommandText> commands;

  // "run [OPTIONS] CONFIG"
  std::string usage() const;
  std::vector<std::string> command_names() const;
};

// What stands between the characters `at`, empty parts too.
std::vector<std::string> split(const std::string& text, char at);

// Without what is hidden (CLI11: of no group). The first line of a description is the summary.
CommandText command_text(const CLI::App& app);

// The words a value may be, for CLI11's type_name() and completions: {"above", "below"}; empty
// where it is no choice of words.
std::vector<std::string> words_of(const Rule& rule);

// What stands for a value of the rule: "{above,below}", "FILE" or "VALUE".
std::string value_name(const Rule& rule);

// A command line and, where it does not say it itself, what it does.
struct Example {
  std::string line, does;
};
// At the end of the command's help, after what else stands there.
void add_examples(CLI::App& command, const std::vector<Example>& examples);

}  // namespace voxweld
