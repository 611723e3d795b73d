#include "pipeline/cli/help_formatter.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/cli/command_text.h"
#include "pipeline/config/text_layout.h"

namespace voxweld {
namespace {

constexpr std::size_t width = 80;
constexpr std::size_t column = 22;  // where descriptions begin

// Lines that begin with blanks are laid out already.
std::string paragraphs(const std::string& text, const std::string& indent) {
  std::string out;
  for (const std::string& line : split(text, '\n'))
    out += line.starts_with(' ') ? indent + line + "\n" : wrapped(line, indent, width);
  return out;
}

// The title on the left, its description to the right of it, or below where it is too long.
std::string entry(const std::string& title, const std::string& text) {
  const std::string indent(column, ' ');
  std::string body = paragraphs(text, indent);
  if (title.size() + 4 > column) return "  " + title + "\n" + body;
  return body.replace(2, title.size(), title);
}

template <class Item>
std::vector<std::string> groups_of(const std::vector<Item>& items) {
  std::vector<std::string> groups;
  for (const Item& item : items)
    if (std::ranges::find(groups, item.group) == groups.end()) groups.push_back(item.group);
  return groups;
}

std::string options_text(const CommandText& command) {
  std::string text, arguments;
  for (const OptionText& option : command.options)
    if (option.argument) arguments += entry(option.title(), option.help);
  if (!arguments.empty()) text += "\nArguments:\n" + arguments;
  for (const std::string& group : groups_of(command.options)) {
    std::string entries;
    for (const OptionText& option : command.options)
      if (!option.argument && option.group == group) entries += entry(option.title(), option.help);
    if (!entries.empty()) text += fmt::format("\n{}:\n{}", group, entries);
  }
  return text;
}

}  // namespace

std::string HelpFormatter::make_help(const CLI::App* app, std::string name,
                                     CLI::AppFormatMode /*mode*/) const {
  const CommandText command = command_text(*app);
  // CLI11 gives the whole way to a command: "voxweld run".
  const std::string before = name.substr(0, name.size() - command.name.size());
  std::string text = paragraphs(command.summary, "");
  if (!command.details.empty()) text += "\n" + paragraphs(command.details, "");
  text += fmt::format("\nUsage: {}{}\n", before, command.usage());
  for (const std::string& group : groups_of(command.commands)) {
    text += fmt::format("\n{}:\n", group);
    for (const CommandText& sub : command.commands)
      if (sub.group == group) text += entry(sub.name, sub.summary);
  }
  text += options_text(command);
  return command.footer.empty() ? text : text + "\n" + command.footer + "\n";
}

}  // namespace voxweld
