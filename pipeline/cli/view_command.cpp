// view: shows meshes in the browser, as long as it runs.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <optional>
#include <thread>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/executor/memory_budget.h"
#include "pipeline/executor/progress.h"
#include "pipeline/view/view_server.h"
#include "pipeline/view/viewer_folder.h"

namespace voxweld {
namespace {

struct ViewArguments {
  std::string input;
  ServerOptions options;
  bool open = false;
  std::optional<std::string> folder;  // to write instead
  bool force = false;
};

// The desktop's browser. It goes on by itself, and says what it says to nobody.
void open_in_browser(const std::string& url) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
  std::string program = "xdg-open", argument = url;
  std::array<char*, 3> arguments{program.data(), argument.data(), nullptr};
  pid_t child = 0;
  const int error =
      posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) spdlog::warn("cannot start xdg-open; open the address yourself");
}

int export_viewer(const ViewArguments& arguments, const Program& program) {
  const std::filesystem::path folder = *arguments.folder;
  const ViewerFolderTotals totals = write_viewer_folder(
      arguments.input, folder, {arguments.force, [&program] { program.interrupt.check(); }});
  fmt::print("{}: {}, {}\n", folder.string(), counted(totals.files, "files"),
             readable_bytes(static_cast<double>(totals.bytes)));
  fmt::print("next: put the folder on any web server, or run `python3 -m http.server -d {}`\n",
             folder.string());
  return 0;
}

int view(const ViewArguments& arguments, const Program& program) {
  if (arguments.folder) return export_viewer(arguments, program);
  const ViewServer server(arguments.input, arguments.options);
  if (!is_loopback(arguments.options.host))
    spdlog::warn("{}: other machines that reach this address can read all files of {}",
                 arguments.options.host, arguments.input);
  fmt::print("{}: {}\n", arguments.input, server.url());
  std::fflush(stdout);  // whoever started it waits for the address
  spdlog::info("open the address in a browser; Ctrl-C ends the viewer");
  if (arguments.open) open_in_browser(server.url());
  while (!program.interrupt.requested()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return 0;
}

}  // namespace

void add_view_command(CLI::App& app, Program& program) {
  auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command = app.add_subcommand(
      "view",
      "Shows meshes in the browser\n"
      "Prints an address to open, and answers there until Ctrl-C. Turn, fly, cut and colour the "
      "mesh, and click it to see where a point lies. Tiles appear as they load; of a mesh with "
      "levels of detail only those as fine as the view needs. Nothing is sent elsewhere and "
      "nothing is loaded from the net.");
  add_examples(*command, {{"voxweld view scan.mesh", ""},
                          {"voxweld view scan.mesh --open", "opens the browser too"},
                          {"voxweld view part.glb --port 8080", "one file, at an address to keep"},
                          {"voxweld view scan.mesh --export scan.page",
                           "the page and the mesh as files, for a web server or somebody else"}});
  add_file(*command, "input", arguments->input,
           "An output directory, or a mesh file: .drc, .glb, .ply, .stl, .obj or .vtp");
  add_value(*command, "--port", arguments->options.port, "Port to listen on; 0: one that is free")
      ->check(CLI::Range(0, 65535));
  add_value(
      *command, "--host", arguments->options.host,
      "Address to listen on; one that is not of this machine alone lets others read the files")
      ->type_name("ADDRESS");
  CLI::Option* open =
      command->add_flag("--open", arguments->open, "Opens the address in the desktop's browser");
  CLI::Option* folder =
      command
          ->add_option("--export", arguments->folder,
                       "Writes the page and what it shows into a folder instead, which any "
                       "web server can hand out")
          ->type_name("FOLDER");
  command->add_flag("--force", arguments->force, "With --export: writes over an earlier one")
      ->needs(folder);
  for (CLI::Option* other : {open, command->get_option("--port"), command->get_option("--host")})
    folder->excludes(other);
  when_chosen(*command, program, [&program, arguments] { return view(*arguments, program); });
}

}  // namespace voxweld
