#include "pipeline/config/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <utility>

#include "pipeline/config/binding.h"

namespace voxweld {
namespace {

constexpr std::int64_t no_limit = std::numeric_limits<std::int64_t>::max();
constexpr std::uint64_t least_memory = std::uint64_t{64} << 20;

using Stages = std::initializer_list<Stage>;
constexpr Stages none = {};
constexpr Stages ingest = {Stage::ingest};
constexpr Stages build = {Stage::build};
constexpr Stages merge = {Stage::merge};
constexpr Stages stitch = {Stage::stitch};
constexpr Stages encode = {Stage::encode};
// What ingest lays out and build reads: the layout of raw samples (build reads them itself where
// there is no copy) and the shape of shards.
constexpr Stages ingest_and_build = {Stage::ingest, Stage::build};
// Merge goes on collapsing above the bricks by the rules of build. Root records need not change
// with them (a higher tolerance may leave every brick as it was), so merge's key names them too.
constexpr Stages collapse = {Stage::build, Stage::merge};
// Octrees and root records are relative to the cell, so their bytes need not change with the
// spacing; the lengths merge and stitch work with do. Samples are the same with any spacing: ingest
// writes no more than the store's metadata anew. Of a mesh, also where its lattice begins, which is
// in the files' coordinates.
constexpr Stages lengths = {Stage::build, Stage::merge, Stage::stitch};
// The open result is the closed one less some polygons, and those are made in stitch.
constexpr Stages border = {Stage::build, Stage::stitch};

struct SettingWords {
  const char* table;
  const char* key;
  const char* description;
  const char* default_note = "";
};

Setting row(SettingWords words, const binding::Binding<Config>& bound, Stages stages) {
  const auto default_value = bound.get(Config{});
  return {{words.key, bound.rule, words.description, false, words.default_note, default_value},
          words.table,
          stages,
          false,
          bound.set,
          bound.get};
}

Setting required(Setting setting) {
  setting.required = true;
  setting.default_note = "required";
  return setting;
}

Setting by_effect(Setting setting) {
  setting.by_effect = true;
  return setting;
}

std::vector<Setting> input_settings() {
  using In = InputConfig;
  constexpr auto in = &Config::input;
  return {
      // What the file holds is in the keys by content, so moving it re-runs nothing.
      required(
          row({"input", "path",
               "The volume: a file, a directory of slices or a Zarr array; or a closed triangle "
               "mesh in an .stl, .off, .obj or .ply file. What it holds decides what is done "
               "again, not its name."},
              binding::member(in, &In::path, PathRule{}), none)),
      row({"input", "format",
           "How to read it. \"auto\" goes by the content and the name. \"empty\" is no file but "
           "empty space of input.size, for what [[edit]] makes in it: it needs no path and no "
           "isovalue. \"mesh\" needs no isovalue either, but a resolution or cell."},
          binding::input_format(), ingest),
      row({"input", "crop", "The box of samples to use, half-open: [x0, y0, z0, x1, y1, z1].",
           "the whole volume"},
          binding::member(in, &In::crop, IntegerListRule{6, 0, most_samples}), ingest_and_build),
      row({"input", "spacing",
           "Distance of neighbouring samples: one number or [x, y, z]. Overrides the file's.",
           "as the file says, else 1"},
          binding::member(in, &In::spacing, SpacingRule{}), lengths),
      row({"input", "unit", "Unit of the spacing. Overrides the file's.", "as the file says"},
          binding::unit(), encode),
      row({"input", "dataset",
           "Which array or grid, where a file holds several: its path or name in the file. "
           "`voxweld info` lists them, and what the next four can be.",
           "the only one there is"},
          binding::selected(&InputSelection::dataset), ingest_and_build),
      row({"input", "series",
           "DICOM: which series, where a folder holds several: its UID, or its number.",
           "the only one there is"},
          binding::selected(&InputSelection::series), ingest_and_build),
      row({"input", "level", "Which resolution of a pyramid. 0 is the finest.", "the finest"},
          binding::selected(&InputSelection::level), ingest_and_build),
      row({"input", "channel", "Which channel, counted from 0.", "the only one there is"},
          binding::selected(&InputSelection::channel), ingest_and_build),
      row({"input", "time", "Which point in time, counted from 0.", "the only one there is"},
          binding::selected(&InputSelection::time), ingest_and_build),
      row({"input", "resample",
           "DICOM: what to do where slices are not equally far apart. \"none\" refuses them; "
           "\"uniform\" interpolates slices at equal distances."},
          binding::choice(in, &In::resample, {"none", "uniform"}), ingest_and_build),
      row({"input", "size",
           "Raw files and empty space: samples along [x, y, z], x fastest in the file.",
           "none; raw files and empty space need it"},
          binding::member(in, &In::size, IntegerListRule{3, 1, most_samples}), ingest_and_build),
      row({"input", "type", "Raw only: type of a sample.", "none; raw files need it"},
          binding::raw_type(), ingest_and_build),
      row({"input", "endian", "Raw only: byte order of a sample."},
          binding::choice(in, &In::endian, {"little", "big"}), ingest_and_build),
      row({"input", "header_bytes", "Raw only: bytes before the first sample."},
          binding::member(in, &In::header_bytes, IntegerRule{0, no_limit}), ingest_and_build),
      row({"input", "follow",
           "NRRD and MetaImage: lets a header name data files by absolute paths, or outside its "
           "own "
           "folder."},
          binding::member(in, &In::follow, FlagRule{}), none),
      row({"input", "resolution",
           "Meshes only: cells along the longest side of the mesh's bounding box, the margin not "
           "counted.",
           "none; meshes need it, or input.cell"},
          binding::member(in, &In::resolution, IntegerRule{least_resolution, most_resolution}),
          lengths),
      row({"input", "cell", "Meshes only: the side of a cell, in the mesh's own unit.",
           "none; meshes need it, or input.resolution"},
          binding::member(in, &In::cell, PositiveNumberRule{}), lengths),
      row({"input", "margin",
           "Meshes only: cells of empty space around the mesh's bounds, and half a cell more. "
           "Solids that [[edit]] adds need room there."},
          binding::member(in, &In::margin, IntegerRule{1, 65536}), lengths),
      row({"input", "close",
           "Meshes only: \"no\" refuses one that is not closed; \"winding\" closes its holes, and "
           "makes one of what overlaps: inside is where its triangles wind around at least half "
           "(generalized winding number)."},
          binding::choice(in, &In::close, {"no", "winding"}), build),
  };
}

std::vector<Setting> work_settings() {
  using Work = WorkConfig;
  constexpr auto work = &Config::work;
  return {
      row({"work", "directory",
           "Where intermediate files and finished work are kept, to resume from.",
           "\"<config name>.work\" beside the config"},
          binding::member(work, &Work::directory, PathRule{}), none),
      row({"work", "chunk",
           "Samples a side of the brick store's chunks. At most brick * shard. Never changes the "
           "result."},
          binding::member(work, &Work::chunk, PowerOfTwoRule{8, 256}), ingest),
      row({"work", "brick", "Cells a side of a brick: one octree. Never changes the result."},
          binding::member(work, &Work::brick, PowerOfTwoRule{16, 256}), ingest_and_build),
      row({"work", "shard",
           "Bricks a side of a shard, one store file and build task. Never changes the result."},
          binding::member(work, &Work::shard, PowerOfTwoRule{1, 16}), ingest_and_build),
      row({"work", "copy",
           "Copy the samples into the brick store first. \"auto\" copies only inputs that cannot "
           "be read in boxes."},
          binding::switch_of(work, &Work::copy), none),
  };
}

std::vector<Setting> surface_settings() {
  using Surface = SurfaceConfig;
  constexpr auto surface = &Config::surface;
  return {
      required(row({"surface", "isovalue",
                    "The value the surface runs through; \"otsu\" chooses it from the histogram. "
                    "Where the file has a slope and an intercept it is a real value, such as HU, "
                    "not a stored number. Integers above 9223372036854775807 are written in "
                    "quotes."},
                   binding::isovalue(), build)),
      row({"surface", "label",
           "Of a label volume: the label whose surface to extract, in place of an isovalue. Inside "
           "are the samples of this value; crossings and normals come from a filter over five "
           "samples a side, so that they are smooth.",
           "none: the surface is at the isovalue"},
          binding::surface_label(), build),
      row({"surface", "inside", "Which side of the isovalue is material. Equal is inside."},
          binding::choice(surface, &Surface::inside, {"above", "below"}), build),
      row({"surface", "border",
           "\"closed\" caps material that reaches the volume's border; \"open\" leaves it open."},
          binding::choice(surface, &Surface::border, {"closed", "open"}), border),
      row({"surface", "gradient",
           "How normals are estimated: \"eno\" keeps sharp features, \"central\" blurs noise."},
          binding::choice(surface, &Surface::gradient, {"eno", "central"}), build),
  };
}

std::vector<Setting> labels_settings() {
  using Labels = LabelsConfig;
  constexpr auto labels = &Config::labels;
  return {
      row({"labels", "mode",
           "Take the samples for labels instead of comparing them with an isovalue. \"each\": one "
           "closed mesh for every label; \"shared\": one non-manifold mesh of them all, in "
           "which neighbours share triangles."},
          binding::choice(labels, &Labels::mode, {"off", "each", "shared"}), build),
      by_effect(row({"labels", "select",
                     "The labels to mesh: \"all\", \"mapped\" (those that labels.map names) or a "
                     "list. They are sample values, before labels.map merges any; those above "
                     "9223372036854775807 are written in quotes."},
                    binding::selected_labels(), build)),
      by_effect(row(
          {"labels", "background", "Labels that are left out, unless labels.select lists them."},
          binding::background(), build)),
      by_effect(
          row({"labels", "map",
               "A file that merges labels, leaves some out, and gives names and colours: CSV, "
               "JSON, a colour table of 3D Slicer or label descriptions of ITK-SNAP. The columns "
               "of a CSV are label (needed), material (what the label becomes part of; -1 leaves "
               "it out), name, and color or r, g and b. Labels it does not name are kept. What it "
               "holds decides what is done again, not its name.",
               "none"},
              binding::member(labels, &Labels::map, PathRule{}), build)),
      by_effect(row(
          {"labels", "min_voxels", "Leave out what has fewer samples, after labels were merged."},
          binding::member(labels, &Labels::min_voxels, IntegerRule{0, no_limit}), build)),
      by_effect(row({"labels", "max_voxels",
                     "Leave out what has more samples, after labels were merged; 0: no limit."},
                    binding::member(labels, &Labels::max_voxels, IntegerRule{0, no_limit}), build)),
  };
}

std::vector<Setting> simplify_settings() {
  using Simplify = SimplifyConfig;
  constexpr auto simplify = &Config::simplify;
  return {
      row({"simplify", "enabled", "Collapse octree cells where the surface allows it."},
          binding::member(simplify, &Simplify::enabled, FlagRule{}), collapse),
      row({"simplify", "tolerance", "How far a vertex may be from the surface it stands for."},
          binding::member(simplify, &Simplify::tolerance, PositiveNumberRule{}), collapse),
      row({"simplify", "tolerance_unit",
           "\"voxel\": in smallest spacings; \"physical\": in the spacing's unit."},
          binding::choice(simplify, &Simplify::tolerance_unit, {"voxel", "physical"}), collapse),
      row({"simplify", "metric",
           "\"rms\": root mean square of the distances; \"sum\": root of their summed squares, "
           "so each is within tolerance."},
          binding::choice(simplify, &Simplify::metric, {"rms", "sum"}), collapse),
      row({"simplify", "topology",
           "\"safe\" keeps the surface's topology; \"free\" lets it change and promises no "
           "manifold."},
          binding::choice(simplify, &Simplify::topology, {"safe", "free"}), collapse),
      row({"simplify", "qef",
           "Solves the QEFs. \"qr\": stable in floats; \"normal\": normal equations, to compare."},
          binding::choice(simplify, &Simplify::qef, {"qr", "normal"}), collapse),
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
           "The most vertices a tile may have. \"auto\" is 500000, and less where run.memory is "
           "too "
           "small to encode several such tiles at once."},
          binding::integer_or_auto(output, &Output::tile_vertices, IntegerRule{1024, 1000000000}),
          merge),
      row({"output", "precision",
           "The step coordinates are rounded to, at most, in smallest spacings."},
          binding::member(output, &Output::precision, PositiveNumberRule{}), stitch),
      row({"output", "normals", "Write normals."},
          binding::member(output, &Output::normals, FlagRule{}), stitch),
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

std::vector<Setting> make_settings() {
  std::vector<Setting> all;
  for (auto make : {input_settings, work_settings, surface_settings, labels_settings,
                    simplify_settings, output_settings, run_settings, slurm_settings})
    for (Setting& setting : make()) all.push_back(std::move(setting));
  return all;
}

}  // namespace

std::string_view stage_name(Stage stage) {
  constexpr std::array<std::string_view, 5> names = {"ingest", "build", "merge", "stitch",
                                                     "encode"};
  return names[static_cast<std::size_t>(stage)];
}

bool Setting::read_by(Stage stage) const {
  return std::ranges::find(stages, stage) != stages.end();
}

std::string Setting::stages_text() const {
  std::vector<std::string_view> names;
  for (const Stage stage : stages) names.push_back(stage_name(stage));
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

std::string KeyFacts::default_text() const {
  if (!default_note.empty()) return default_note;
  return default_value ? to_toml(*default_value) : "";
}

std::span<const Setting> settings() {
  static const std::vector<Setting> all = make_settings();
  return all;
}

const Setting* find_setting(std::string_view table, std::string_view key) {
  for (const Setting& setting : settings())
    if (setting.table == table && setting.key == key) return &setting;
  return nullptr;
}

std::vector<std::string> table_names() {
  std::vector<std::string> names;
  for (const Setting& setting : settings())
    if (names.empty() || names.back() != setting.table) names.push_back(setting.table);
  return names;
}

std::vector<std::string> key_names(std::string_view table) {
  std::vector<std::string> names;
  for (const Setting& setting : settings())
    if (setting.table == table) names.push_back(setting.key);
  return names;
}

std::string_view table_description(std::string_view table) {
  if (table == "input") return "The volume, and what its file does not say.";
  if (table == "work") return "How the work is cut up and where it is kept.";
  if (table == "surface") return "Which surface to extract.";
  if (table == "labels") return "Label volumes: which labels to mesh, and how.";
  if (table == "simplify") return "How far to simplify it.";
  if (table == "output") return "What to write.";
  if (table == "run") return "What the run may use. Never changes the result.";
  return "How the tasks of run.executor = \"slurm\" are submitted. Never changes the result.";
}

}  // namespace voxweld
