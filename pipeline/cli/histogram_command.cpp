#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <span>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/number_option.h"
#include "pipeline/cli/output_file.h"
#include "pipeline/cli/volume_arguments.h"
#include "pipeline/info/histogram_picture.h"
#include "pipeline/info/histogram_view.h"
#include "storage/image/image_file.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/json_text.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

struct HistogramArguments {
  VolumeArguments volume;
  std::vector<std::string> outputs;
  bool force = false;
  int cells = 0;  // 0: as what is written has room for
  std::vector<double> range;
};

constexpr int terminal_lines = 32, file_cells = 256, picture_width = 1024, picture_height = 480;

int terminal_columns() {
  winsize size{};
  constexpr int usual = 100, most = 160;
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return usual;
  return std::min<int>(size.ws_col, most);
}

void write(const HistogramView& view, const std::string& output) {
  if (lower(std::filesystem::path(output).extension().string()) == ".json") {
    write_whole_file(output, as_bytes(json_text(to_json(view))), Durability::fsync);
  } else {
    const HistogramPicture picture = draw_histogram(view, picture_width, picture_height);
    write_png(output, {picture.width, picture.height, 3}, std::as_bytes(std::span(picture.rgb)));
  }
  fmt::print("{}\n", output);
}

void refuse_outputs(const HistogramArguments& arguments, const SampleSource& source) {
  for (const std::string& output : arguments.outputs) {
    check_ending(output, std::vector<std::string>{".png", ".json"}, "a histogram");
    check_free(output, arguments.force);
    for (const InputFile& file : source.info().files) refuse_input(output, file.path);
  }
}

int show_histogram(const HistogramArguments& arguments, Program& program) {
  const std::shared_ptr<SampleSource> source = open_volume(input_spec(arguments.volume));
  refuse_outputs(arguments, *source);
  for (const std::string& warning : source->info().warnings) spdlog::warn("{}", warning);
  HistogramOptions options;
  const bool text = arguments.outputs.empty();
  options.cells = arguments.cells > 0 ? arguments.cells : text ? terminal_lines : file_cells;
  if (!arguments.range.empty()) options.range.emplace(arguments.range[0], arguments.range[1]);
  const HistogramView view =
      view_histogram(*source, arguments.volume.path, options, scan_hooks(program, "histogram"));
  program.console->clear_status();
  if (text) fmt::print("{}", to_text(view, terminal_columns()));
  for (const std::string& output : arguments.outputs) write(view, output);
  return 0;
}

}  // namespace

void add_histogram_command(CLI::App& app, Program& program) {
  auto arguments = std::make_shared<HistogramArguments>();
  CLI::App* command = app.add_subcommand("histogram",
                                         "Shows how often a volume's values occur\n"
                                         "Marks the isovalues that \"otsu\" and \"valley\" choose. "
                                         "Prints bars on a logarithmic scale, "
                                         "or writes a picture or JSON. Reads all samples once.");
  add_file(*command, "path", arguments->volume.path, "The volume");
  command
      ->add_option("-o,--output", arguments->outputs,
                   "Writes a .png or .json file in place of text; may be given twice")
      ->type_name("FILE");
  command->add_flag("--force", arguments->force, "Replaces files that are there");
  command
      ->add_option("--bins", arguments->cells,
                   "The most bars; 32 in text, 256 in files where it is not given")
      ->check(CLI::Range(2, 65536));
  add_numbers(*command, "--range", arguments->range, {2},
              "The values to show: lowest and highest; else all but the outermost 0.1 %");
  add_volume_options(*command, arguments->volume);
  add_examples(*command, {{"voxweld histogram scan.nii.gz", "where are the peaks?"},
                          {"voxweld histogram scan.nii.gz -o scan.png -o scan.json", ""},
                          {"voxweld histogram ct.nii.gz --range -200 500", "soft tissue only"}});
  when_chosen(*command, program,
              [&program, arguments] { return show_histogram(*arguments, program); });
}

}  // namespace voxweld
