// view: shows meshes in the browser, as long as it runs.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <thread>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/view/view_server.h"

namespace voxweld {
namespace {

struct ViewArguments {
  std::string input;
  ServerOptions options;
  bool open = false;
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

int view(const ViewArguments& arguments, const Program& program) {
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
  add_examples(*command,
               {{"voxweld view scan.mesh", ""},
                {"voxweld view scan.mesh --open", "opens the browser too"},
                {"voxweld view part.glb --port 8080", "one file, at an address to keep"}});
  add_file(*command, "input", arguments->input,
           "An output directory, or a mesh file: .drc, .glb, .ply, .stl, .obj or .vtp");
  add_value(*command, "--port", arguments->options.port, "Port to listen on; 0: one that is free")
      ->check(CLI::Range(0, 65535));
  add_value(
      *command, "--host", arguments->options.host,
      "Address to listen on; one that is not of this machine alone lets others read the files")
      ->type_name("ADDRESS");
  command->add_flag("--open", arguments->open, "Opens the address in the desktop's browser");
  when_chosen(*command, program, [&program, arguments] { return view(*arguments, program); });
}

}  // namespace voxweld
