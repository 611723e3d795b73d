#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/output_file.h"
#include "pipeline/executor/progress.h"
#include "pipeline/phantom/write.h"
#include "stages/ingest/statistics.h"
#include "storage/store/shard_writer.h"
#include "storage/store/zarr_metadata.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

struct PhantomArguments {
  std::string kind, type = "uint16", unit;
  OutputFile output;
  std::int64_t size = 256;
  std::uint64_t seed = 1, first_label = 1;
  double spacing = 1;
};

std::string phantom_description() {
  std::string text = "Writes a volume of a known solid, for demos and tests\nKinds:";
  for (const PhantomKindInfo& kind : phantom_kinds())
    text += fmt::format("\n  {:<9} {}", kind.name, kind.summary);
  return text;
}

// For CLI11's type_name().
std::string kind_names() {
  std::vector<std::string_view> names;
  for (const PhantomKindInfo& kind : phantom_kinds()) names.push_back(kind.name);
  return fmt::format("{{{}}}", fmt::join(names, ","));
}

void write_zarr(const SampleSource& source, const std::filesystem::path& path) {
  StoreLayout layout;
  layout.array = path;
  layout.records = default_records_directory(path);
  layout.type = source.info().type;
  layout.geometry = source.info().geometry;
  write_store_metadata(layout);
  HistogramStatistics statistics(layout.type);
  ShardScratch scratch;
  const Index3 grid = layout.shard_grid();
  for (std::int64_t z = 0; z < grid.z; ++z)
    for (std::int64_t y = 0; y < grid.y; ++y)
      for (std::int64_t x = 0; x < grid.x; ++x)
        write_shard(layout, {x, y, z}, Hash128{}, source, statistics, scratch);
}

// A Zarr array is a folder: only one that is an array is written over.
void check_place(const OutputFile& output) {
  const std::filesystem::path path = output.path;
  const bool array = holds_zarr_array(path);
  if (phantom_format(path) == PhantomFormat::zarr && array && output.force) return;
  if (phantom_format(path) == PhantomFormat::zarr && array)
    throw InputError(output.path +
                     ": exists already; use --force to write over it, or -o for another name");
  for (const std::filesystem::path& file : phantom_files(path)) check_free(file, output.force);
}

int make_phantom(const PhantomArguments& arguments, Program& program) {
  const auto type = parse_sample_type(arguments.type);
  if (!type)
    throw InputError("--type " + arguments.type +
                     ": unknown; use uint8, uint16 or float32, of labels any integer type");
  PhantomSpec spec;
  spec.volume = {parse_phantom_kind(arguments.kind),
                 arguments.size,
                 *type,
                 arguments.seed,
                 {arguments.spacing, arguments.spacing, arguments.spacing},
                 arguments.unit,
                 arguments.first_label};
  spec.path = arguments.output.path;
  check_place(arguments.output);
  PhantomHooks hooks;
  hooks.cancelled = [&] { return program.interrupt.requested(); };
  hooks.zarr = write_zarr;
  hooks.progress = [&](double share) {
    if (shows_progress(program.log_level))
      program.console->status(fmt::format("phantom {:.0f} %", 100 * share));
  };
  write_phantom(spec, hooks);
  program.console->clear_status();
  const auto isovalue = phantom_isovalue(spec.volume.kind, *type);
  fmt::print("{}: {} x {} x {} {}{}\n", arguments.output.path, arguments.size, arguments.size,
             arguments.size, arguments.type,
             isovalue
                 ? fmt::format(", surface.isovalue = {}, surface.inside = \"below\"", *isovalue)
                 : "");
  return 0;
}

}  // namespace

void add_phantom_command(CLI::App& app, Program& program) {
  auto arguments = std::make_shared<PhantomArguments>();
  CLI::App* command = app.add_subcommand("phantom", phantom_description());
  add_examples(*command,
               {{"voxweld phantom gyroid --size 128 --spacing 0.5 --unit mm -o gyroid.nrrd",
                 "then: voxweld init gyroid.nrrd"}});
  command->add_option("kind", arguments->kind, "What to make")->type_name(kind_names())->required();
  add_value(*command, "--size", arguments->size, "Samples along each side");
  add_value(*command, "--type", arguments->type,
            "uint8, uint16 or float32; of labels and junctions any integer type");
  add_output_file(*command, arguments->output,
                  "The file: .nrrd, .nhdr (with .raw beside it), .raw or .zarr");
  add_value(*command, "--seed", arguments->seed,
            "Of porous, labels and noise: another one for each");
  add_value(*command, "--first-label", arguments->first_label,
            "Of labels and junctions: the number of the first, the others count on");
  add_value(*command, "--spacing", arguments->spacing,
            "Distance of neighbouring samples, as the file records it");
  command->add_option("--unit", arguments->unit, "Unit of the spacing, such as mm");
  when_chosen(*command, program,
              [&program, arguments] { return make_phantom(*arguments, program); });
}

}  // namespace voxweld
