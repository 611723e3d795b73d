// What becomes of the surface, and how the work runs.
#include "pipeline/config/setting_rows.h"

namespace voxweld::rows {
namespace {

constexpr std::uint64_t least_memory = std::uint64_t{64} << 20;

// What the pipeline relies on to find its tasks again, and what would make sbatch wait or do
// something else than submit.
const std::vector<std::string>& reserved_options() {
  static const std::vector<std::string> names = {
      "--array",   "-a", "--job-name", "-J", "--output",    "-o",           "--error",
      "-e",        "-d", "--chdir",    "-D", "--open-mode", "--dependency", "--parsable",
      "--wrap",    "-W", "--wait",     "-M", "--clusters",  "--cluster",    "--test-only",
      "--version", "-V", "--help",     "-h", "--usage"};
  return names;
}

}  // namespace

std::vector<Setting> simplify_settings() {
  using Simplify = SimplifyConfig;
  constexpr auto simplify = &Config::simplify;
  return {
      row({"simplify", "enabled", "Collapse octree cells where the surface allows it."},
          binding::member(simplify, &Simplify::enabled, FlagRule{}), collapse),
      row({"simplify", "tolerance",
           "Limits two steps. First cells are merged: how far a vertex may then be from the "
           "part of the surface that it stands for. With refine = \"collapse\" edges go after "
           "that: how far this may move the mesh."},
          binding::member(simplify, &Simplify::tolerance, PositiveNumberRule{}), tolerance),
      row({"simplify", "tolerance_unit",
           "\"voxel\": in smallest spacings; \"physical\": in the spacing's unit."},
          binding::choice(simplify, &Simplify::tolerance_unit, {"voxel", "physical"}), tolerance),
      row({"simplify", "metric",
           "\"rms\": root mean square of the distances; \"sum\": root of their summed squares, "
           "so each is within tolerance."},
          binding::choice(simplify, &Simplify::metric, {"rms", "sum"}), collapse),
      row({"simplify", "topology",
           "\"manifold\" and \"safe\" keep the surface's topology. \"manifold\" collapses each of "
           "the sheets in a cell by itself; \"safe\" all of them or none, and so less. With "
           "labels.mode = \"shared\" the two are the same. \"free\" lets the topology change and "
           "promises no manifold."},
          binding::choice(simplify, &Simplify::topology, {"manifold", "safe", "free"}), collapse),
      row({"simplify", "qef",
           "Solves the QEFs. \"qr\": stable in floats; \"normal\": normal equations, to compare."},
          binding::choice(simplify, &Simplify::qef, {"qr", "normal"}), collapse),
      by_effect(row(
          {"simplify", "refine",
           "What is done to the mesh once it is stitched. \"repair\": triangles that cut each "
           "other are mended, and what is not near them stays; \"collapse\": vertices go where "
           "they best lie, out of their cells if need be, and edges are collapsed too, as far as "
           "tolerance lets them. \"auto\": \"collapse\", but \"off\" where cells are not (enabled "
           "= false), or "
           "with topology = \"free\"."},
          binding::choice(simplify, &Simplify::refine, {"auto", "off", "repair", "collapse"}),
          refined_from_build)),
      when_given(row(
          {"simplify", "intersections",
           "Which triangles may cut each other, unless refine is \"off\". \"none\": they are "
           "mended, and no new ones are made; \"report\": they stay, and are counted; \"ignore\": "
           "they stay, and nobody looks.",
           "\"none\""},
          binding::choice_or_open(simplify, &Simplify::intersections, {"none", "report", "ignore"}),
          refined)),
      when_given(row(
          {"simplify", "triangles",
           "How many triangles the mesh is to have in the end, of all labels together. A run finds "
           "out how far edges have to be collapsed for it, in place of tolerance; cells still go "
           "by tolerance. Not where refine is \"off\" or \"repair\". After an edit the whole mesh "
           "may change.",
           "none: tolerance decides"},
          binding::member(simplify, &Simplify::triangles, IntegerRule{1, no_limit}), chosen)),
      when_given(
          row({"simplify", "ratio",
               "Like triangles, but as a part of the triangles that there are without refine. Only "
               "one of the two can be given.",
               "none: tolerance decides"},
              binding::member(simplify, &Simplify::ratio, PartRule{}), chosen)),
  };
}

std::vector<Setting> output_settings() {
  using Output = OutputConfig;
  constexpr auto output = &Config::output;
  return {
      row({"output", "directory", "Where the meshes and the manifest go.",
           "\"<config name>.mesh\" beside the config"},
          binding::member(output, &Output::directory, PathRule{}), none),
      row({"output", "formats", "The file formats to write."}, binding::formats(), encode),
      row({"output", "merged",
           "Also write the whole mesh as one file. \"auto\" does where it is small enough."},
          binding::switch_of(output, &Output::merged), encode),
      row({"output", "tiles", "Write the tiles, the pieces of the mesh, as files of their own."},
          binding::member(output, &Output::tiles, FlagRule{}), encode),
      row({"output", "tile_vertices",
           "The most vertices a tile may have. \"auto\" is 250000, or 65536 with levels of "
           "detail, or 131072 with labels.mode = \"shared\", and less where run.memory is too "
           "small to encode several such tiles at once."},
          binding::integer_or_auto(output, &Output::tile_vertices, IntegerRule{1024, 1000000000}),
          merge),
      row({"output", "levels",
           "Levels of detail. Compared with the level before, each has tiles twice as wide and "
           "four times the tolerance, or eight times where its tiles would have too many "
           "triangles. 1: the mesh alone; \"auto\": until one tile holds all of it. A coarse tile "
           "has parts of many labels. More than 1 needs tiles and a refined mesh."},
          binding::integer_or_auto(output, &Output::levels, IntegerRule{1, 12}), levels),
      row({"output", "precision",
           "The step coordinates are rounded to, at most, in smallest spacings."},
          binding::member(output, &Output::precision, PositiveNumberRule{}), stitch),
      row({"output", "normals", "Write normals."},
          binding::member(output, &Output::normals, FlagRule{}), stitch),
      row({"output", "report",
           "Write report.html: a page about the run, with pictures of the mesh and slices of the "
           "volume."},
          binding::member(output, &Output::report, FlagRule{}), none),
  };
}

std::vector<Setting> run_settings() {
  using Run = RunConfig;
  constexpr auto run = &Config::run;
  return {
      row({"run", "executor",
           "Where the work runs: \"local\" in this process, \"slurm\" as tasks of a cluster (see "
           "[slurm])."},
          binding::choice(run, &Run::executor, {"local", "slurm"}), none),
      row({"run", "threads", "Threads to use; 0: as many as the machine has."},
          binding::member(run, &Run::threads, IntegerRule{0, 4096}), none),
      row({"run", "memory", "The most memory a process may use."},
          binding::memory(run, &Run::memory, MemoryRule{least_memory}), none),
  };
}

std::vector<Setting> slurm_settings() {
  using Slurm = SlurmConfig;
  constexpr auto slurm = &Config::slurm;
  return {
      row({"slurm", "partition", "The partition to submit to; \"\": the cluster's default."},
          binding::member(slurm, &Slurm::partition, NameRule{}), none),
      row({"slurm", "account", "The account to charge; \"\": the user's default."},
          binding::member(slurm, &Slurm::account, NameRule{}), none),
      row({"slurm", "qos", "The quality of service to ask for; \"\": the cluster's default."},
          binding::member(slurm, &Slurm::qos, NameRule{}), none),
      row({"slurm", "time", "The time limit of one task, as sbatch takes it."},
          binding::member(slurm, &Slurm::time, TimeLimitRule{}), none),
      row({"slurm", "cpus_per_task", "Processors of one task, and the threads it runs."},
          binding::member(slurm, &Slurm::cpus_per_task, IntegerRule{1, 1024}), none),
      row({"slurm", "mem",
           "Memory to ask for a task. \"auto\" asks for run.memory and a margin, so that a task is "
           "not killed for what the system counts besides."},
          binding::memory(slurm, &Slurm::mem, MemoryRule{least_memory, true}), none),
      row({"slurm", "max_array",
           "The most tasks of one job array. The cluster's own limit is MaxArraySize."},
          binding::member(slurm, &Slurm::max_array, IntegerRule{1, 1000000}), none),
      row({"slurm", "max_running", "The most tasks to run at once; 0: no limit but the cluster's."},
          binding::member(slurm, &Slurm::max_running, IntegerRule{0, 1000000}), none),
      row({"slurm", "shards_per_task",
           "Shards one task works through. \"auto\" goes by how many there are."},
          binding::integer_or_auto(slurm, &Slurm::shards_per_task, IntegerRule{1, no_limit}), none),
      row({"slurm", "retries", "How often a task that failed or was lost is submitted again."},
          binding::member(slurm, &Slurm::retries, IntegerRule{0, 100}), none),
      row({"slurm", "extra",
           "Further options for sbatch, each as it would stand after #SBATCH: "
           "[\"--constraint=avx2\", \"--exclusive\"]."},
          binding::member(slurm, &Slurm::extra, OptionListRule{reserved_options()}), none),
      row({"slurm", "prologue",
           "Shell lines to run before a task's command: [\"module load gcc/12\"]."},
          binding::member(slurm, &Slurm::prologue, LineListRule{}), none),
  };
}

}  // namespace voxweld::rows
