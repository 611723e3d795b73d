#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/config_path.h"
#include "pipeline/cli/run_context.h"
#include "pipeline/config/edit_settings.h"
#include "pipeline/config/edit_text.h"
#include "pipeline/config/number_list.h"
#include "pipeline/config/refuse.h"
#include "pipeline/solids/closed_mesh.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

struct EditArguments {
  RunArguments run;
  std::string added;  // the shape; empty: nothing is added
  std::optional<std::size_t> changed, removed;
  bool list = false, no_run = false;
  std::map<std::string, std::string> keys;  // those given, as they were typed
};

// What was typed for a key, as a config holds it.
ConfigValue value_of(const EditSetting& setting, const std::string& text, const fs::path& config,
                     const std::string& option) {
  const std::string where = option + " " + shown(text);
  const std::optional<ConfigValue> value = typed_value(setting.rule, text);
  if (!value)
    throw InputError(fmt::format("{}: {}: expected {}, found {}, which is not valid TOML", where,
                                 setting.key, accepted_text(setting.rule), shown(text)));
  require_accepted(where, setting.key, setting, *value);
  if (std::holds_alternative<PathRule>(setting.rule))
    return ConfigValue{path_for_config(*value->text(), config)};
  return *value;
}

// In the order of keys in a config file.
EditKeys typed_keys(const EditArguments& arguments) {
  EditKeys keys;
  for (const EditSetting& setting : edit_settings()) {
    const bool shape = setting.key == "shape" && !arguments.added.empty();
    const auto given = arguments.keys.find(setting.key);
    if (!shape && given == arguments.keys.end()) continue;
    keys.emplace_back(setting.key,
                      value_of(setting, shape ? arguments.added : given->second,
                               arguments.run.config, shape ? "--add" : "--" + setting.key));
  }
  return keys;
}

// An edit that becomes another shape loses the keys that the new one does not take.
std::vector<std::string> keys_to_drop(const EditKeys& given) {
  const auto is = [](std::string_view key) {
    return [=](const auto& k) { return k.first == key; };
  };
  const auto shape = std::ranges::find_if(given, is("shape"));
  std::vector<std::string> names;
  if (shape == given.end()) return names;
  EditConfig edit;
  find_edit_setting("shape")->set(edit, shape->second);
  for (const EditSetting& setting : edit_settings())
    if (!setting.taken_by(edit.shape) && std::ranges::none_of(given, is(setting.key)))
      names.push_back(setting.key);
  return names;
}

// One line: what is at its default is left out.
std::string line_of(const EditConfig& edit) {
  std::string what, keys;
  for (const EditValue& value : values_of(edit)) {
    const EditSetting& setting = *value.setting;
    if (setting.key == "op" || setting.key == "shape")
      what += (what.empty() ? "" : " ") + *value.value.text();
    else if (setting.required || value.value != setting.default_value)
      keys += fmt::format("{} {} = {}", keys.empty() ? "" : ",", setting.key, to_toml(value.value));
  }
  return what + keys;
}

int list(const EditArguments& arguments) {
  const Config config = load_config(arguments.run.config, arguments.run.overrides);
  for (std::size_t i = 0; i < config.edits.size(); ++i)
    fmt::print("{} {}\n", i + 1, line_of(config.edits[i]));
  if (config.edits.empty()) fmt::print("no edits\n");
  return 0;
}

void check_arguments(const EditArguments& arguments) {
  const int asked = (arguments.added.empty() ? 0 : 1) + (arguments.changed ? 1 : 0) +
                    (arguments.removed ? 1 : 0) + (arguments.list ? 1 : 0);
  if (asked != 1)
    throw InputError(fmt::format(
        "edit: expected one of --add SHAPE, --change N, --remove N and --list, found {}",
        asked == 0 ? "none" : "several"));
  if (!arguments.keys.empty() && (arguments.list || arguments.removed))
    throw InputError(fmt::format("--{}: belongs to --add or --change, found {}",
                                 arguments.keys.begin()->first,
                                 arguments.list ? "--list" : "--remove"));
  if (arguments.changed && arguments.keys.empty())
    throw InputError(fmt::format("--change {}: expected a key to change, as --{}",
                                 *arguments.changed, fmt::join(edit_key_names(), ", --")));
  if (!arguments.added.empty() && arguments.keys.contains("shape"))
    throw InputError("--shape: is of --change; with --add the shape is the word behind it");
}

// Which of the edits was added or changed.
std::size_t edited(const EditArguments& arguments, const Config& config) {
  return arguments.changed.value_or(config.edits.size()) - 1;
}

// Makes the change; returns what was done, for the terminal.
std::string apply(const EditArguments& arguments, EditText& text) {
  if (arguments.removed) {
    text.remove(*arguments.removed);
    return fmt::format("edit {} removed", *arguments.removed);
  }
  const EditKeys keys = typed_keys(arguments);
  if (!arguments.changed) {
    text.add(keys);
    return fmt::format("edit {} added", text.count());
  }
  text.change(*arguments.changed, keys);
  text.drop(*arguments.changed, keys_to_drop(keys));
  return fmt::format("edit {} changed", *arguments.changed);
}

[[noreturn]] void refuse_change(const EditArguments& arguments, const Error& error) {
  throw InputError(fmt::format("{} is left as it is; so changed it would be refused: {}",
                               arguments.run.config, error.what()));
}

// What the file would be. The mesh of the edit in question is one that can be used.
Config checked(const EditArguments& arguments, const std::string& text) {
  try {
    Config config = parse_config(text, arguments.run.config, arguments.run.overrides);
    if (arguments.removed) return config;
    const EditConfig& edit = config.edits[edited(arguments, config)];
    if (edit.shape == SolidShape::mesh) read_closed_mesh(edit.path, config.run.memory, edit.close);
    return config;
  } catch (const InputError& error) {
    refuse_change(arguments, error);
  } catch (const FormatError& error) {
    refuse_change(arguments, error);
  }
}

// In the place a link leads to, with the permissions it has.
void write(const EditArguments& arguments, const std::string& text) {
  const fs::path path = fs::canonical(arguments.run.config);
  if (access(path.c_str(), W_OK) != 0)
    throw InputError(path.string() + ": is write-protected, so it is left as it is");
  const fs::perms permissions = fs::status(path).permissions();
  write_whole_file(path, as_bytes(text), Durability::fsync);
  fs::permissions(path, permissions);
}

// "done: 2 of 64 shards built (9 of their bricks, 119 kept), 3 of 5 tiles stitched"
std::string work_done(const RunContext& context) {
  const auto of = [&](std::string_view stage) {
    StageReport sum;
    for (const StageReport& report : context.reports)
      if (report.stage == stage) sum.ran += report.ran, sum.units = report.units;
    return fmt::format("{} of {}", sum.ran, sum.units);
  };
  const BrickReport& bricks = context.bricks;
  const std::string kept =
      bricks.kept > 0 ? fmt::format(" ({} of their bricks, {} kept)", bricks.built, bricks.kept)
                      : "";
  return fmt::format("done: {} shards built{}, {} tiles stitched", of("build"), kept, of("stitch"));
}

int edit(Program& program, const EditArguments& arguments) {
  check_arguments(arguments);
  if (arguments.list) return list(arguments);
  const std::string before = read_config_text(arguments.run.config);
  EditText text(before, arguments.run.config);
  const std::string done = apply(arguments, text);
  const Config config = checked(arguments, text.text());
  if (text.text() != before) write(arguments, text.text());
  fmt::print("{}: {}{}\n", arguments.run.config, done,
             arguments.removed ? "" : ": " + line_of(config.edits[edited(arguments, config)]));
  if (arguments.no_run) return 0;
  std::fflush(stdout);  // a run may take hours
  for (const RunArguments& surface : each_surface(arguments.run)) {
    LocalExecutor here;
    RunContext context = make_context(program, surface, here);
    run_where_asked(program, context);
    fmt::print("{}\n", work_done(context));
    print_summary(context, false);
    std::fflush(stdout);
  }
  return 0;
}

// Of each shape's own keys the help says whose they are.
void add_key_options(CLI::App& command, EditArguments& arguments) {
  for (const EditSetting& setting : edit_settings()) {
    std::string help = setting.description;
    if (words_of(setting.rule).empty()) help += " Takes " + accepted_text(setting.rule) + ".";
    if (!setting.kinds.empty()) help += " Of: " + edit_items().kinds_text(setting) + ".";
    command
        .add_option_function<std::string>(
            "--" + setting.key,
            [&arguments, key = setting.key](const std::string& text) {
              arguments.keys[key] = text;
            },
            help)
        ->type_name(value_name(setting.rule))
        ->group("Keys of the edit (values are TOML; lists: 10,20,30 or [10, 20, 30])");
  }
}

}  // namespace

void add_edit_command(CLI::App& app, Program& program) {
  auto arguments = std::make_shared<EditArguments>();
  CLI::App* command = app.add_subcommand(
      "edit",
      "Adds, changes or removes a solid in a config, then runs it\n"
      "A solid, an [[edit]] of the config, is added to the material, cut out of it or intersected "
      "with it. All else of the file stays as it is written, and only the part of the volume that "
      "the edit reaches is made again.");
  add_examples(*command,
               {{"voxweld edit scan.toml --add sphere --op subtract --center 9,9,4 --radius 2",
                 "cuts a ball out; lengths are in the unit of the spacing"},
                {"voxweld edit scan.toml --change 1 --radius 3", ""},
                {"voxweld edit scan.toml --list", ""}});
  add_config_options(*command, arguments->run);
  const char* group = "What to do (one of these)";
  const Rule& shape = find_edit_setting("shape")->rule;
  command->add_option("--add", arguments->added, "Adds an edit of this shape behind the others")
      ->type_name(value_name(shape))
      ->group(group);
  command->add_option("--change", arguments->changed, "Gives keys of this edit other values")
      ->type_name("N")
      ->group(group);
  command->add_option("--remove", arguments->removed, "Removes this edit")
      ->type_name("N")
      ->group(group);
  command->add_flag("--list", arguments->list, "Lists the edits with their numbers, one a line")
      ->group(group);
  command->add_flag("--no-run", arguments->no_run, "Changes the config and runs nothing");
  add_key_options(*command, *arguments);
  when_chosen(*command, program, [&program, arguments] { return edit(program, *arguments); });
}

}  // namespace voxweld
