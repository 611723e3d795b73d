#include "pipeline/cli/run_context.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "pipeline/report/report.h"
#include "pipeline/run/run.h"
#include "pipeline/run/tile_vertices.h"
#include "pipeline/slurm/slurm_run.h"
#include "stages/contouring/qef.h"
#include "storage/manifest/manifest.h"
#include "storage/manifest/report_file.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/provenance.h"

namespace voxweld {
namespace {

// VOXWELD_KERNELS: the instructions of a lesser processor, to try what a mixed cluster does.
void choose_kernels() {
  const char* name = std::getenv("VOXWELD_KERNELS");
  if (name != nullptr && *name != '\0' && !choose_qef_kernels(name))
    throw InputError(
        fmt::format("VOXWELD_KERNELS = \"{}\" in the environment: expected \"base\", \"avx2\" or "
                    "\"avx512\", and "
                    "a processor that has it; unset it to take the widest there is",
                    name));
  set_provenance_kernels(qef_kernels().name);
}

std::optional<Hash128> result_of_file(const RunArguments& arguments) {
  try {
    return result_hash(load_config(arguments.config));
  } catch (const InputError&) {  // a key is given on the command line only
    return std::nullopt;
  }
}

Config chosen_surface(const Config& config, const RunArguments& arguments) {
  const std::vector<OneSurface> surfaces = surfaces_of(config);
  const auto found = std::ranges::find(surfaces, arguments.isovalue, &OneSurface::isovalue);
  if (found != surfaces.end()) return found->config;
  if (surfaces.front().isovalue.empty())
    throw InputError(fmt::format("--isovalue {}: {} has no list of isovalues; leave it out",
                                 arguments.isovalue, arguments.config));
  std::string known;
  for (const OneSurface& one : surfaces) known += (known.empty() ? "" : ", ") + one.isovalue;
  throw InputError(
      arguments.isovalue.empty()
          ? fmt::format("{}: surface.isovalue is a list, and this command works on one surface: "
                        "choose it with --isovalue, of {}",
                        arguments.config, known)
          : fmt::format("--isovalue {}: {} has none such; it has {}", arguments.isovalue,
                        arguments.config, known));
}

}  // namespace

void add_config_options(CLI::App& command, RunArguments& arguments) {
  add_file(command, "config", arguments.config,
           "The config file (TOML); `voxweld init` writes one, `voxweld settings` lists its keys");
  command
      .add_option("--set", arguments.overrides,
                  "Gives a key of the config another value, for this once: surface.isovalue=300. "
                  "May be given again")
      ->type_name("KEY=VALUE")
      ->take_all();
  command
      .add_option("--isovalue", arguments.isovalue,
                  "Of a config with a list of isovalues: this one alone, as the list has it")
      ->type_name("VALUE");
}

std::vector<RunArguments> each_surface(const RunArguments& arguments) {
  if (!arguments.isovalue.empty()) return {arguments};
  std::vector<RunArguments> all;
  for (const OneSurface& one : surfaces_of(load_config(arguments.config, arguments.overrides))) {
    all.push_back(arguments);
    all.back().isovalue = one.isovalue;
  }
  return all;
}

RunContext make_context(Program& program, const RunArguments& arguments, Executor& executor) {
  RunContext context;
  const Config whole = load_config(arguments.config, arguments.overrides);
  context.config = chosen_surface(whole, arguments);
  context.config_file = std::filesystem::canonical(arguments.config);
  context.config_result =
      arguments.overrides.empty() ? result_hash(whole) : result_of_file(arguments);
  context.force = arguments.force;
  // On a cluster many tasks read what one has read: the brick store is made for that.
  if (context.config.run.executor == RunConfig::Executor::slurm &&
      context.config.work.copy == WorkConfig::Copy::automatic)
    context.config.work.copy = WorkConfig::Copy::always;
  fit_tiles(context.config);
  context.executor = &executor;
  context.console = program.console;
  context.progress.enabled = shows_progress(program.log_level);
  context.interrupt = &program.interrupt;
  const int machine = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  context.threads =
      context.config.run.threads > 0 ? static_cast<int>(context.config.run.threads) : machine;
  choose_kernels();
  set_provenance_config(config_fingerprint(context.config));
  return context;
}

namespace {

// The page about the run. That there is none is no failure of the run.
void report_run(const RunContext& context) {
  const OutputConfig& output = context.config.output;
  if (!output.report) return;
  const std::filesystem::path file = output.directory / report_name;
  const ReportOptions options{output.directory, file, context.threads > 1,
                              context.config.run.memory, context.interrupt};
  try {
    if (std::filesystem::exists(file) && !is_report(file) && !context.force)
      throw InputError(fmt::format(
          "{}: is there and voxweld did not write it; rename it, or set output.report = false",
          file.string()));
    if (report_is_current(options)) return;
    remove_file(file);  // it is of an earlier run
    write_report(options);
    spdlog::info("report: {}", file.string());
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    spdlog::warn("no report is written: {}", error.what());
  }
}

}  // namespace

void run_where_asked(Program& program, RunContext& context) {
  SlurmClientOptions patience;
  patience.interrupt = &program.interrupt;
  SlurmClient client(patience);
  std::optional<SlurmExecutor> cluster;
  Executor* const here = context.executor;
  if (context.config.run.executor == RunConfig::Executor::slurm) {
    cluster.emplace(set_up_slurm(context.config, client), client);
    context.executor = &*cluster;
  }
  run_all(context, [&] { report_run(context); });
  context.executor = here;
}

namespace {

// "refined: 12 edges collapsed, 3 vertices moved, 0 edges flipped; 4 pairs of triangles intersected,
// 0 still do; points of the mesh before: 99 % within 0.05 mm, all within 0.1 mm"
std::string refine_summary(const nlohmann::json& refine) {
  const auto number = [&](const char* key) { return refine.at(key).get<std::uint64_t>(); };
  const std::string unit = refine.at("unit").get<std::string>();
  const auto length = [&](const char* key) {
    return fmt::format("{:.3g}{}{}", refine.at(key).get<double>(), unit.empty() ? "" : " ", unit);
  };
  return fmt::format(
      "refined: {} collapsed, {} moved, {} flipped; {} of triangles intersected, {} still do; "
      "points of the mesh before: 99 % within {}, all within {}",
      counted(number("collapses"), "edges"), counted(number("moves"), "vertices"),
      counted(number("flips"), "edges"), counted(number("intersecting_before"), "pairs"),
      number("intersecting_left"), length("p99"), length("worst"));
}

}  // namespace

void print_summary(const RunContext& context, bool json) {
  const std::filesystem::path& output = context.config.output.directory;
  if (json) {
    fmt::print("{}", read_text_file(output / manifest_name));
    return;
  }
  const Manifest manifest = read_manifest(output / manifest_name);
  const ManifestCounts& counts = manifest.counts;
  // A refined mesh is no longer one of quads.
  const std::string polygons =
      manifest.refine ? ""
                      : fmt::format(" ({} and {} before cutting)", counted(counts.quads, "quads"),
                                    counted(counts.polygon_triangles, "triangles"));
  fmt::print("{}: {}, {}{}, {}, {}, {}\n", output.string(), counted(counts.vertices, "vertices"),
             counted(counts.triangles, "triangles"), polygons, counted(counts.tiles, "tiles"),
             counted(counts.files, "files"), readable_bytes(static_cast<double>(counts.bytes)));
  if (manifest.refine) fmt::print("{}\n", refine_summary(*manifest.refine));
}

}  // namespace voxweld
