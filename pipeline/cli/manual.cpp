#include "pipeline/cli/manual.h"

#include <fmt/format.h>

#include <cctype>
#include <set>

#include "pipeline/config/edit_settings.h"
#include "pipeline/config/filter_settings.h"
#include "pipeline/config/settings.h"

namespace voxweld {
namespace {

// What roff would take for its own: backslashes, dashes, and dots and quotes that begin a line.
std::string roff(const std::string& text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    line_begins = c == '\n';
  }
  return out;
}

// Lines that begin with blanks are laid out already.
std::string prose(const std::string& text) {
  std::string out;
  bool laid_out = false;
  for (const std::string& line : split(text, '\n')) {
    if (line.empty()) continue;
    if (line.starts_with(' ') != laid_out) {
      laid_out = !laid_out;
      out += laid_out ? ".nf\n" : ".fi\n";
    }
    out += roff(line) + "\n";
  }
  return laid_out ? out + ".fi\n" : out;
}

std::string item(const std::string& title, const std::string& text) {
  return fmt::format(".TP\n.B \"{}\"\n{}", roff(title), prose(text));
}

// Examples and the like, with their own heading or none.
std::string footer_text(const std::string& footer) {
  return footer.empty() ? "" : ".PP\n" + prose(footer);
}

std::string command_section(const CommandText& command) {
  std::string text = fmt::format(".SS \"voxweld {}\"\n{}", roff(command.usage()),
                                 prose(command.summary + ".\n" + command.details));
  std::string group = "Options";
  for (const OptionText& option : command.options) {
    if (option.names.front() == "-h") continue;
    if (!option.argument && option.group != group)
      text += fmt::format(".PP\n{}:\n", roff(group = option.group));
    text += item(option.title(), option.help);
  }
  return text + footer_text(command.footer);
}

std::string commands_text(const CommandText& all) {
  std::string text = ".SH COMMANDS\n";
  for (const CommandText& command : all.commands) text += command_section(command);
  return text;
}

std::string key_text(const KeyFacts& key) {
  return item(key.key, fmt::format("{} Takes {}. Default: {}.", key.description,
                                   accepted_text(key.rule), key.default_text()));
}

std::string config_text() {
  std::string text =
      ".SH CONFIG FILE\nTOML. Relative paths begin at the config's folder. Sizes of memory are "
      "text such as \"4GiB\".\n";
  for (const std::string& table : table_names()) {
    text += fmt::format(".SS \"[{}]\"\n{}", table, prose(std::string(table_description(table))));
    for (const Setting& setting : settings())
      if (setting.table == table) text += key_text(setting);
  }
  const auto add_items = [&](const auto& table) {
    text += fmt::format(".SS \"[[{}]]\"\n{}", table.name, prose(table.description));
    for (const auto& setting : table.settings) text += key_text(setting);
  };
  add_items(filter_items());
  add_items(edit_items());
  return text;
}

std::string environment_text() {
  return ".SH ENVIRONMENT\n" +
         item("VOXWELD_MODULE_DIR",
              "The folder with libvoxweld_image.so, which reads and writes images. It is also "
              "looked for beside the program and in ../lib/voxweld from there.") +
         item("VOXWELD_KERNELS",
              "\"base\", \"avx2\" or \"avx512\": the processor instructions to use, where not the "
              "widest there are. No result depends on it.") +
         item("SLURM_ARRAY_TASK_ID", "Set by Slurm; names the file of --report in a folder.");
}

}  // namespace

std::string manual_page(const CommandText& all) {
  std::string text = fmt::format(
      ".TH VOXWELD 1 \"\" \"voxweld {}\" \"User Commands\"\n.SH NAME\nvoxweld \\- meshes from "
      "scanned volumes too large for memory\n.SH SYNOPSIS\n.B voxweld\n[OPTIONS] COMMAND "
      "...\n.SH DESCRIPTION\n{}",
      VOXWELD_VERSION, prose(all.summary + "\n" + all.details));
  text += footer_text(all.footer) + ".SH OPTIONS\nEvery command takes them.\n";
  for (const OptionText& option : all.options) text += item(option.title(), option.help);
  text += commands_text(all) + config_text() + environment_text();
  text += ".SH EXIT STATUS\n" + item("0", "Done.") +
          item("1", "A failure under way. Run again to go on.") +
          item("2", "Something to mend first: in the command, the config or the input.");
  return text;
}

}  // namespace voxweld
