#include <fmt/format.h>

#include "pipeline/cli/commands.h"
#include "pipeline/config/commented.h"
#include "pipeline/config/help.h"
#include "pipeline/config/schema.h"

namespace voxweld {

void add_settings_command(CLI::App& app, Program& program) {
  struct Arguments {
    bool json = false, example = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("settings", "Lists every key of the config file");
  command->add_flag("--json", arguments->json, "Prints a JSON schema, for editors");
  command->add_flag("--example", arguments->example, "Prints a config file with every key");
  when_chosen(*command, program, [arguments] {
    fmt::print("{}", arguments->json      ? config_schema_json()
                     : arguments->example ? reference_config()
                                          : settings_help());
    return 0;
  });
}

}  // namespace voxweld
