#include "pipeline/cli/command_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace voxweld {
namespace {

// CLI11 calls a choice "TEXT:{a,b}" and a range "INT:INT in [1 - 9]".
std::vector<std::string> choices_in(const std::string& type) {
  const auto open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  return split(type.substr(open + 1, close - open - 1), ',');
}

std::string value_of(const CLI::Option& option, const std::vector<std::string>& choices) {
  if (option.get_type_size() == 0) return {};
  if (!choices.empty()) return fmt::format("{{{}}}", fmt::join(choices, ","));
  const std::string type = split(option.get_type_name(), ':').front();
  const std::string one = type == "INT" || type == "UINT" ? "N" : type == "FLOAT" ? "NUMBER" : type;
  std::string all = one;
  for (int i = 1; i < option.get_expected_min(); ++i) all += " " + one;
  const bool repeats = option.get_expected_max() > option.get_expected_min();
  return repeats && type != "KEY=VALUE" && type != "X,Y,Z" ? all + "..." : all;
}

std::string help_of(const CLI::Option& option) {
  std::string help = option.get_description();
  if (!option.get_default_str().empty())
    help += fmt::format(" (default: {})", option.get_default_str());
  if (option.get_required() && !option.get_positional()) help += " (required)";
  for (const CLI::Option* other : option.get_excludes())
    help += fmt::format(" (not with {})", other->get_name());
  return help;
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

OptionText option_text(const CLI::Option& option) {
  OptionText text;
  text.argument = option.get_positional();
  if (text.argument) text.names.push_back(upper(option.get_name(true)));
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  text.required = option.get_required();
  text.choices = choices_in(option.get_type_name());
  text.value = value_of(option, text.choices);
  text.help = help_of(option);
  text.group = option.get_group();
  return text;
}

}  // namespace

std::string OptionText::title() const {
  const std::string all = fmt::format("{}", fmt::join(names, ", "));
  return argument || value.empty() ? all : all + " " + value;
}

std::string CommandText::usage() const {
  std::string text = name + " [OPTIONS]";
  for (const OptionText& option : options)
    if (option.argument)
      text += option.required ? " " + option.names.front() : " [" + option.names.front() + "]";
  return commands.empty() ? text : text + " COMMAND";
}

std::vector<std::string> CommandText::command_names() const {
  std::vector<std::string> names;
  for (const CommandText& command : commands) names.push_back(command.name);
  return names;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
    end = text.find(at, begin);
    parts.push_back(text.substr(begin, end - begin));
  }
  return parts;
}

CommandText command_text(const CLI::App& app) {
  CommandText text;
  const std::string& description = app.get_description();
  const auto line_end = description.find('\n');
  text.name = app.get_name();
  text.group = app.get_group() == "Subcommands" ? "Commands" : app.get_group();
  text.summary = description.substr(0, line_end);
  if (line_end != std::string::npos) text.details = description.substr(line_end + 1);
  text.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options())
    if (!option->get_group().empty()) text.options.push_back(option_text(*option));
  std::ranges::stable_partition(text.options, &OptionText::argument);
  for (const CLI::App* command : app.get_subcommands({}))
    if (!command->get_group().empty()) text.commands.push_back(command_text(*command));
  return text;
}

std::vector<std::string> words_of(const Rule& rule) {
  if (const auto* choice = std::get_if<ChoiceRule>(&rule)) return choice->names;
  if (std::holds_alternative<FlagRule>(rule)) return {"true", "false"};
  if (std::holds_alternative<SwitchRule>(rule)) return {"auto", "true", "false"};
  return {};
}

std::string value_name(const Rule& rule) {
  if (std::holds_alternative<PathRule>(rule)) return "FILE";
  const std::vector<std::string> words = words_of(rule);
  return words.empty() ? "VALUE" : fmt::format("{{{}}}", fmt::join(words, ","));
}

void add_examples(CLI::App& command, const std::vector<Example>& examples) {
  std::string text = command.get_footer();
  text += text.empty() ? "Examples:" : "\n\nExamples:";
  for (const Example& example : examples) {
    text += "\n  " + example.line;
    if (!example.does.empty()) text += "\n      " + example.does;
  }
  command.footer(text);
}

}  // namespace voxweld
