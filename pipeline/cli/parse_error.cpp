#include "pipeline/cli/parse_error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <optional>
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

// What stands before and after `between`, as in "--cell excludes --resolution".
struct Around {
  std::string before, after;
};
std::optional<Around> around(const std::string& text, const std::string& between) {
  const auto at = text.find(between);
  if (at == std::string::npos) return std::nullopt;
  return Around{text.substr(0, at), text.substr(at + between.size())};
}

// As the help names it: CLI11 calls an argument "input", the help INPUT.
const OptionText* option_of(const CommandText& command, const std::string& name) {
  const auto called = [&](const std::string& other) {
    return std::ranges::equal(name, other, [](unsigned char a, unsigned char b) {
      return std::toupper(a) == std::toupper(b);
    });
  };
  for (const OptionText& option : command.options)
    if (std::ranges::any_of(option.names, called)) return &option;
  return nullptr;
}

std::string name_in_help(const CommandText& command, const std::string& name) {
  const OptionText* option = option_of(command, name);
  return option == nullptr ? name : option->names.back();
}

std::string missing(const CommandText& command, const std::string& name) {
  const OptionText* option = option_of(command, name);
  if (option == nullptr) return name + " is missing";
  std::string help = option->help.substr(0, option->help.find(" (required)"));
  const bool acronym = help.size() > 1 && std::isupper(static_cast<unsigned char>(help[1]));
  if (!help.empty() && !acronym)
    help[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(help[0])));
  const std::string what =
      option->names.back() +
      (option->value.empty() || option->argument ? std::string() : " " + option->value);
  return fmt::format("{} is missing: {}", what, help);
}

std::string value_expected(const CommandText& command, const std::string& name) {
  const OptionText* option = option_of(command, name);
  const std::string value = option == nullptr ? std::string() : option->value;
  return value == "N" ? "a whole number" : value == "NUMBER" ? "a number" : "a value";
}

// Of a value: what CLI11 says after the option's name.
std::string refused_value(const std::string& what) {
  if (const auto range = around(what, " not in range ");
      range && range->before.starts_with("Value ")) {
    const auto ends = around(range->after, " to ");
    // The end of CLI::PositiveNumber is the largest double, with all its digits.
    const std::string found = range->before.substr(std::string("Value ").size());
    if (ends && ends->after.size() > 100) return "expected a number above 0, found " + found;
    if (ends)
      return fmt::format("expected a number from {} to {}, found {}", ends->before, ends->after,
                         found);
  }
  if (const auto choice = around(what, " not in {"); choice && choice->after.ends_with('}')) {
    const std::vector<std::string> words =
        split(choice->after.substr(0, choice->after.size() - 1), ',');
    return fmt::format("expected {}, found {}", fmt::join(words, " or "), choice->before);
  }
  return what;
}

// CLI11's words, such as "--sharded requires --neuroglancer", as a sentence that says what to do.
std::string plain_words(const CLI::ParseError& error, const CommandText& command) {
  std::string text = error.what();
  std::ranges::replace(text, '\n', ' ');
  const auto name = [&](const std::string& of) { return name_in_help(command, of); };
  if (const auto two = around(text, " excludes "))
    return fmt::format("{} and {} do not go together; leave one of them out", name(two->before),
                       name(two->after));
  if (const auto two = around(text, " requires "))
    return fmt::format("{} goes only with {}; add that, or leave {} out", name(two->before),
                       name(two->after), name(two->before));
  if (const auto one = around(text, " is required"); one && one->after.empty())
    return missing(command, one->before);
  if (const auto value = around(text, "Could not convert: "))
    if (const auto two = around(value->after, " = "))
      return fmt::format("{}: expected {}, found {}", two->before,
                         value_expected(command, two->before), two->after);
  const auto told = around(text, ": ");
  if (!told) return text;
  if (dynamic_cast<const CLI::ValidationError*>(&error) != nullptr)
    return fmt::format("{}: {}", name(told->before), refused_value(told->after));
  if (told->after.ends_with(" missing"))
    return fmt::format("{}: expected {} after it, found nothing", told->before,
                       value_expected(command, told->before));
  if (const auto most = around(told->after, " required but received "))
    if (most->before == "At Most 1")
      return fmt::format("{} is there {} times; give it once", name(told->before), most->after);
  return text;
}

std::string not_expected(const std::vector<std::string>& left) {
  return fmt::format("{} not expected; leave {} out, or quote a name that has spaces",
                     left.size() == 1
                         ? fmt::format("the argument \"{}\" is", left.front())
                         : fmt::format("the arguments \"{}\" are", fmt::join(left, "\", \"")),
                     left.size() == 1 ? "it" : "them");
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
  else if (!chosen.empty() && !left.empty())
    text = not_expected(left);
  else
    text = plain_words(error, chosen.empty() ? all : command_text(*chosen.front()));
  const char* end = text.ends_with('?') ? "" : ";";
  return fmt::format("{}: {}{} `{} --help` explains", command, text, end, command);
}

}  // namespace voxweld
