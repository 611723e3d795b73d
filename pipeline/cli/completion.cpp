#include "pipeline/cli/completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pipeline/config/settings.h"

namespace voxweld {
namespace {

using Words = std::vector<std::string>;

// Those of the command, and those that every command takes.
std::vector<OptionText> options_of(const CommandText& command, const CommandText& all) {
  std::vector<OptionText> options = command.options;
  for (const OptionText& option : all.options)
    if (std::ranges::none_of(options, [&](const OptionText& o) { return o.names == option.names; }))
      options.push_back(option);
  return options;
}

// "surface.inside=", "surface.isovalue=" ...
Words setting_names() {
  Words names;
  for (const Setting& setting : settings()) names.push_back(setting.name() + "=");
  return names;
}

// "surface.inside=above", "surface.inside=below"; empty where the key takes other than words.
Words setting_values(const Setting& setting) {
  Words values;
  for (const std::string& word : words_of(setting.rule))
    values.push_back(setting.name() + "=" + word);
  return values;
}

std::string joined(const Words& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

// In single quotes no shell expands anything; a quote itself ends them.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text)
    if (c == '\'')
      out += "'\\''";
    else
      out += c == '\n' ? ' ' : c;
  return out + "'";
}

// The first sentence of an option's help.
std::string brief(const std::string& help) {
  return help.substr(0, std::min(help.find('\n'), help.find(". ")));
}

// bash

std::string bash_answer(const OptionText& option) {
  if (!option.choices.empty()) return fmt::format("choices='{}'", joined(option.choices));
  if (option.takes_setting()) return "_voxweld_settings";
  return option.takes_file() ? "files=1" : ":";
}

// What a command offers: after an option its values, after a dash options, else its argument.
std::string bash_cases(const CommandText& command, const CommandText& all) {
  std::string text, names, argument = ":";
  for (const OptionText& option : options_of(command, all)) {
    if (option.argument) {
      if (argument == ":") argument = bash_answer(option);
      continue;
    }
    names += (names.empty() ? "" : " ") + joined(option.names);
    if (option.value.empty()) continue;
    for (const std::string& name : option.names)
      text += fmt::format("    {}:{}) {} ;;\n", command.name, name, bash_answer(option));
  }
  if (!command.commands.empty())
    argument = fmt::format("choices='{}'", joined(command.command_names()));
  return text + fmt::format("    {}:*) if [[ $cur == -* ]]; then choices='{}'; else {}; fi ;;\n",
                            command.name, names, argument);
}

constexpr const char* bash_begin =
    R"(# Completion of voxweld in bash; `voxweld completion bash` prints it.
_voxweld() {
  local line=${COMP_LINE:0:COMP_POINT} word command=voxweld choices='' files=''
  local -a words
  read -ra words <<<"$line"
  [[ $line == *[[:space:]] ]] && words+=('')
  local cur=${words[-1]} prev=${words[-2]}
  for word in "${words[@]:1:${#words[@]}-2}"; do
    case $word in
)";

constexpr const char* bash_end = R"(  esac
  if [[ $files ]]; then
    mapfile -t COMPREPLY < <(compgen -f -- "$cur")
    compopt -o filenames 2>/dev/null
    return
  fi
  mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$cur")
  # A key goes on with its value.
  [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *= ]] && compopt -o nospace 2>/dev/null
  # The shell replaces only what stands behind the last "=".
  [[ $COMP_WORDBREAKS == *=* && $cur == *=* ]] && COMPREPLY=("${COMPREPLY[@]#"${cur%=*}="}")
  return 0
}
)";

std::string bash_settings() {
  std::string text = "_voxweld_settings() {\n  case $cur in\n";
  for (const Setting& setting : settings())
    if (const Words values = setting_values(setting); !values.empty())
      text += fmt::format("    {}=*) choices='{}' ;;\n", setting.name(), joined(values));
  return text + fmt::format("    *) choices='{}' ;;\n  esac\n}}\n", joined(setting_names()));
}

// zsh

// In the specifications of _arguments colons and brackets have a meaning.
std::string zsh_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_action(const OptionText& option) {
  if (!option.choices.empty()) return fmt::format("({})", joined(option.choices));
  if (option.takes_setting()) return "_voxweld_settings";
  return option.takes_file() ? "_files" : "";
}

std::string zsh_spec(const OptionText& option, const std::string& name) {
  const std::string help = zsh_escaped(brief(option.help));
  const std::string action = zsh_action(option);
  if (option.argument) return quoted(fmt::format(":{}:{}", zsh_escaped(name), action));
  const char* again = option.takes_setting() ? "*" : "";
  if (option.value.empty()) return quoted(fmt::format("{}[{}]", name, help));
  return quoted(fmt::format("{}{}[{}]:{}:{}", again, name, help, "value", action));
}

std::string zsh_arguments(const std::vector<OptionText>& options, const std::string& indent) {
  std::string text;
  for (const OptionText& option : options)
    for (const std::string& name : option.names)
      text += fmt::format(" \\\n{}  {}", indent, zsh_spec(option, name));
  return text;
}

std::string zsh_settings() {
  std::string text = "_voxweld_settings() {\n  case $PREFIX in\n";
  for (const Setting& setting : settings())
    if (const Words values = setting_values(setting); !values.empty())
      text += fmt::format("    {}=*) compadd -- {} ;;\n", setting.name(), joined(values));
  return text + fmt::format("    *) compadd -S '' -- {} ;;\n  esac\n}}\n", joined(setting_names()));
}

// fish

// The options of fish's `complete` that say what may follow.
std::string fish_values(const OptionText& option) {
  if (!option.choices.empty()) return fmt::format(" -x -a {}", quoted(joined(option.choices)));
  if (option.takes_setting()) return " -x -a '(__voxweld_settings)'";
  if (option.takes_file()) return " -r -F";
  return option.value.empty() ? "" : " -x";
}

std::string fish_option(const std::string& condition, const OptionText& option) {
  if (option.argument && option.choices.empty() && !option.takes_file()) return {};
  std::string names;
  for (const std::string& name : option.names)
    if (!option.argument)
      names += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  const std::string about = option.argument ? "" : " -d " + quoted(brief(option.help));
  return fmt::format("complete -c voxweld{}{}{}{}\n", condition, names, fish_values(option), about);
}

}  // namespace

std::string bash_completion(const CommandText& all) {
  std::string text = bash_begin;
  text += fmt::format("      {}) command=$word && break ;;\n    esac\n  done\n",
                      fmt::join(all.command_names(), "|"));
  text += "  case $command:$prev in\n";
  for (const CommandText& command : all.commands) text += bash_cases(command, all);
  text += bash_cases(all, all);
  return text + bash_end + bash_settings() + "complete -F _voxweld voxweld\n";
}

std::string zsh_completion(const CommandText& all) {
  std::string text =
      "#compdef voxweld\n# Completion of voxweld in zsh; `voxweld completion zsh` "
      "prints it.\n" +
      zsh_settings();
  text += "_voxweld() {\n  local context state state_descr line\n  typeset -A opt_args\n";
  text += "  local -a commands\n  commands=(\n";
  for (const CommandText& command : all.commands)
    text += fmt::format("    {}\n", quoted(command.name + ":" + zsh_escaped(command.summary)));
  text += "  )\n  _arguments -C" + zsh_arguments(all.options, "  ") +
          " \\\n    '1:command:->command' '*::argument:->argument'\n";
  text += "  case $state in\n    command) _describe command commands ;;\n";
  text += "    argument)\n      case $words[1] in\n";
  for (const CommandText& command : all.commands)
    text += fmt::format("        {}) _arguments{} ;;\n", command.name,
                        zsh_arguments(options_of(command, all), "          "));
  text += "      esac ;;\n  esac\n}\n";
  // Found in $fpath the file is the function; sourced it only defines it.
  return text +
         "if [[ $funcstack[1] == _voxweld ]]; then _voxweld \"$@\"; else compdef _voxweld voxweld; "
         "fi\n";
}

std::string fish_completion(const CommandText& all) {
  std::string text = "# Completion of voxweld in fish; `voxweld completion fish` prints it.\n";
  text += "function __voxweld_settings\n  printf '%s\\n'";
  for (const std::string& name : setting_names()) text += " " + name;
  for (const Setting& setting : settings())
    for (const std::string& value : setting_values(setting)) text += " " + value;
  text += "\nend\ncomplete -c voxweld -f\n";
  for (const OptionText& option : all.options) text += fish_option("", option);
  for (const CommandText& command : all.commands)
    text += fmt::format("complete -c voxweld -n __fish_use_subcommand -a {} -d {}\n", command.name,
                        quoted(command.summary));
  for (const CommandText& command : all.commands) {
    const std::string condition = fmt::format(" -n '__fish_seen_subcommand_from {}'", command.name);
    for (const OptionText& option : command.options)
      if (option.names.front() != "-h") text += fish_option(condition, option);
  }
  return text;
}

}  // namespace voxweld
