#include <fmt/format.h>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/volume_arguments.h"
#include "pipeline/info/info.h"

namespace voxweld {

void add_info_command(CLI::App& app, Program& program) {
  struct Arguments {
    VolumeArguments volume;
    InfoOptions options;
    bool json = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "info",
      "Says what a file or folder holds\n"
      "Takes a volume, a mesh, a config, an output or work directory of a run, or any file in "
      "one, or a folder that was exported for Neuroglancer or "
      "for browsers.");
  add_file(*command, "path", arguments->volume.path,
           "A file, a folder or a pattern in quotes: 'slices/*.tif'");
  command->add_flag("--json", arguments->json, "Prints it as JSON");
  command->add_flag("--check", arguments->options.check,
                    "Reads all of it and compares it with its checksums; exits with 1 for damage");
  command->add_flag("--histogram", arguments->options.histogram,
                    "Reads the samples of a volume however many there are, for their range and "
                    "histogram");
  command->add_flag(
      "--labels", arguments->options.labels,
      "Counts the labels of a volume: how many there are, the largest, the background");
  command->add_flag("--verbose", arguments->options.verbose,
                    "Also lists bricks, tiles, shards or files one by one");
  add_volume_options(*command, arguments->volume);
  add_examples(*command, {{"voxweld info scan.nii.gz", "size, type, spacing, range of the samples"},
                          {"voxweld info 'slices/*.tif'", "a stack of images"},
                          {"voxweld info scan.mesh --check", "looks for damage"}});
  when_chosen(*command, program, [&program, arguments] {
    InfoOptions& options = arguments->options;
    options.input = input_spec(arguments->volume);
    options.input.survey = true;
    options.hooks = scan_hooks(program, "reading");
    const InfoDocument document = describe(options);
    program.console->clear_status();
    fmt::print("{}", arguments->json ? to_json_text(document) : to_text(document));
    return found_damage(document) ? 1 : 0;
  });
}

}  // namespace voxweld
