#include "pipeline/cli/parse_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "pipeline/cli/command_text.h"
#include "pipeline/config/suggest.h"

namespace voxweld {
namespace {

std::string unknown(const std::string& what, const std::string& name,
                    const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(name, known);
  return fmt::format("no {} is called \"{}\"{}", what, name,
                     nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest));
}

std::vector<std::string> option_names(const CommandText& all, const CommandText& chosen) {
  std::vector<std::string> names;
  for (const CommandText* command : {&chosen, &all})
    for (const OptionText& option : command->options)
      if (!option.argument) names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

// CLI11's words for the rest: "--size: 3 required INT missing".
std::string own_words(const CLI::ParseError& error) {
  std::string text = error.what();
  std::ranges::replace(text, '\n', ' ');
  return text;
}

}  // namespace

std::string parse_error_text(const CLI::App& app, const CLI::ParseError& error) {
  const CommandText all = command_text(app);
  const auto chosen = app.get_subcommands();
  const std::vector<std::string> left = app.remaining(true);
  const auto option =
      std::ranges::find_if(left, [](const std::string& word) { return word.starts_with('-'); });
  std::string text, command = app.get_name();
  if (!chosen.empty()) command += " " + chosen.front()->get_name();
  if (option != left.end())
    text = unknown("option", option->substr(0, option->find('=')),
                   option_names(all, chosen.empty() ? all : command_text(*chosen.front())));
  else if (chosen.empty() && !left.empty())
    text = unknown("command", left.front(), all.command_names());
  else if (chosen.empty() && dynamic_cast<const CLI::RequiredError*>(&error) != nullptr)
    text = "expected a command, such as: voxweld init scan.nii.gz";
  else
    text = own_words(error);
  const char* end = text.ends_with('?') ? "" : ";";
  return fmt::format("{}: {}{} `{} --help` explains", command, text, end, command);
}

}  // namespace voxweld
