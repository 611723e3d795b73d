// completion and manual: what a package puts beside the program, made from the program itself.
#include <fmt/format.h>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/completion.h"
#include "pipeline/cli/manual.h"

namespace voxweld {

void add_document_commands(CLI::App& app, Program& program) {
  auto shell = std::make_shared<std::string>();
  CLI::App* completion =
      app.add_subcommand("completion", "Prints a completion script for a shell")->group("");
  completion->add_option("shell", *shell, "The shell")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  when_chosen(*completion, program, [&app, shell] {
    const CommandText all = command_text(app);
    fmt::print("{}", *shell == "bash"  ? bash_completion(all)
                     : *shell == "zsh" ? zsh_completion(all)
                                       : fish_completion(all));
    return 0;
  });
  CLI::App* manual = app.add_subcommand("manual", "Prints the manual page")->group("");
  when_chosen(*manual, program, [&app] {
    fmt::print("{}", manual_page(command_text(app)));
    return 0;
  });
}

}  // namespace voxweld
