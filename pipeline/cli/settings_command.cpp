#include <fmt/format.h>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/config/commented.h"
#include "pipeline/config/help.h"
#include "pipeline/config/schema.h"

namespace voxweld {

void add_settings_command(CLI::App& app, Program& program) {
  struct Arguments {
    std::string name;
    bool json = false, example = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("settings", "Lists every key of the config file");
  CLI::Option* name = command->add_option(
      "name", arguments->name, "A table or a key, such as surface or surface.isovalue: only that");
  name->type_name("NAME");
  command->add_flag("--json", arguments->json, "Prints a JSON schema, for editors")->excludes(name);
  command->add_flag("--example", arguments->example, "Prints a config file with every key")
      ->excludes(name);
  add_examples(*command, {{"voxweld settings simplify.tolerance", ""}});
  when_chosen(*command, program, [arguments] {
    fmt::print("{}", arguments->json            ? config_schema_json()
                     : arguments->example       ? reference_config()
                     : !arguments->name.empty() ? settings_help(arguments->name)
                                                : settings_help());
    return 0;
  });
}

}  // namespace voxweld
