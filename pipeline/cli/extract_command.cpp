// extract: the mesh that a larger tolerance gives, from the octrees that a run has left.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/number_option.h"
#include "pipeline/cli/output_file.h"
#include "pipeline/cli/run_context.h"
#include "pipeline/executor/progress.h"
#include "pipeline/output/export.h"
#include "pipeline/output/load.h"
#include "pipeline/run/extract.h"
#include "pipeline/stage/file_layout.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

struct ExtractArguments {
  RunArguments run;
  double tolerance = 0;
  std::vector<double> box;
  OutputFile output;
};

// An output folder like a run's, in place of one file.
bool is_folder(const fs::path& output) {
  std::error_code error;
  return !output.has_filename() || output.extension() == ".mesh" || fs::is_directory(output, error);
}

std::optional<Bounds> box_of(const ExtractArguments& arguments) {
  const std::vector<double>& b = arguments.box;
  if (b.empty()) return std::nullopt;
  const Bounds box{{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
  for (int a = 0; a < 3; ++a)
    if (!(box.lo[a] <= box.hi[a]))
      throw InputError(fmt::format(
          "--box: expected x0,y0,z0,x1,y1,z1 with x0 <= x1 and so on, found {},{},{},{},{},{}",
          b[0], b[1], b[2], b[3], b[4], b[5]));
  if (is_folder(arguments.output.path))
    throw InputError(fmt::format(
        "--box: {} is an output folder, and that is for whole meshes; give -o the name of a file",
        arguments.output.path));
  return box;
}

// The format of the mesh that `output` is, or is converted from.
std::string format_of(const fs::path& output) {
  const MeshWriter* writer = writer_of_file(mesh_writers(), lower(output.filename().string()));
  if (writer != nullptr) return std::string(writer->name);
  try {
    check_export_name(output);
  } catch (const InputError&) {
    throw InputError(fmt::format(
        "{}: expected a mesh file, {} or .off; or an output folder, with the ending .mesh or a / "
        "behind it",
        output.string(), endings_text(mesh_writers(), ", ")));
  }
  return "drc";
}

// Where the one file is made.
void aim_at_file(const ExtractArguments& arguments, RunContext& context) {
  const std::string format = format_of(arguments.output.path);
  KeyHasher name;
  name.text("extract").text(format).real(arguments.tolerance);
  for (const double b : arguments.box) name.real(b);
  OutputConfig& output = context.config.output;
  output.directory = extract_folder(context.config.work.directory, name.finish());
  output.formats = {format};
  output.merged = OutputConfig::Merged::always;
  output.tiles = false;
  output.levels = 1;
}

std::size_t write_file(const ExtractArguments& arguments, const Program& program,
                       const fs::path& made) {
  const fs::path& output = arguments.output.path;
  const DecodedMesh mesh = load_mesh(made);
  const bool as_made = made.extension() == lower(output.extension().string());
  write_exported(output, as_made ? read_text_file(made) : exported_mesh(mesh, output),
                 &program.interrupt);
  return mesh.triangles.size();
}

std::string cut_text(const RunContext& context) {
  if (context.bricks.cut == 0) return "";
  return fmt::format("; {} cut, {} read", counted(context.bricks.cut, "bricks"),
                     readable_bytes(static_cast<double>(context.bricks.bytes_cut)));
}

int extract(Program& program, const ExtractArguments& arguments) {
  if (!std::isfinite(arguments.tolerance) || arguments.tolerance < 0)
    throw InputError(
        fmt::format("--tolerance {}: expected a number of at least 0", arguments.tolerance));
  const auto begin = std::chrono::steady_clock::now();
  LocalExecutor here;
  const double base = load_config(arguments.run.config, arguments.run.overrides).simplify.tolerance;
  RunArguments run = arguments.run;
  run.overrides.push_back(fmt::format("simplify.tolerance={}", arguments.tolerance));
  run.force = arguments.output.force;
  const std::optional<Bounds> box = box_of(arguments);
  const bool folder = is_folder(arguments.output.path);
  RunContext context = make_context(program, run, here);
  context.extraction = Extraction{base, box};
  if (folder) {
    context.config.output.directory = fs::absolute(arguments.output.path).lexically_normal();
    extract_all(context);
    print_summary(context, false);
    return 0;
  }
  check_free(arguments.output.path, arguments.output.force);
  aim_at_file(arguments, context);
  extract_all(context);
  const fs::path& made = context.config.output.directory;
  const std::size_t triangles = write_file(
      arguments, program,
      made / ("mesh" +
              std::string(writer_named(mesh_writers(), context.config.output.formats[0])->ending)));
  fs::remove_all(made);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  fmt::print("{}: {} in {:.1f} s{}\n", arguments.output.path, counted(triangles, "triangles"),
             took.count(), cut_text(context));
  return 0;
}

}  // namespace

void add_extract_command(CLI::App& app, Program& program) {
  auto arguments = std::make_shared<ExtractArguments>();
  CLI::App* command = app.add_subcommand(
      "extract",
      "Makes a coarser mesh from what a run has left\n"
      "The octrees of a run keep their levels: the mesh of any larger simplify.tolerance is a cut "
      "of them, and no sample of the volume is read. The file is, byte for byte, what a run with "
      "that tolerance writes as the whole mesh. Where simplify.topology is \"manifold\" only.");
  add_examples(*command,
               {{"voxweld extract scan.toml --tolerance 0.8 -o coarse.drc", ""},
                {"voxweld extract scan.toml --tolerance 2 -o coarse.mesh",
                 "a whole output folder, with tiles and manifest"},
                {"voxweld extract scan.toml --tolerance 0.5 --box 0,0,0,40,40,20 -o corner.ply",
                 "only what reaches into a box"}});
  add_config_options(*command, arguments->run);
  command
      ->add_option("--tolerance", arguments->tolerance,
                   "The simplify.tolerance of the mesh, in the config's unit; at least that of the "
                   "config")
      ->type_name("NUMBER")
      ->required();
  add_numbers(*command, "--box", arguments->box, {6},
              "Only the triangles that reach into the box x0, y0, z0, x1, y1, z1, in the "
              "coordinates of the mesh files; the mesh ends there open");
  add_output_file(*command, arguments->output,
                  "The mesh file to write, its ending says how; or an output folder, with the "
                  "ending .mesh or a / behind it");
  when_chosen(*command, program, [&program, arguments] { return extract(program, *arguments); });
}

}  // namespace voxweld
