// The config of a run: what the TOML file and the --set overrides say, defaults filled in, every
// value checked. The keys, their accepted values and the stages that read them are listed once, in
// settings_*.cpp and, for filters and edits, filter_settings.cpp and edit_settings.cpp; the members
// here have the same names.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/support/hash.h"
#include "storage/types/box.h"
#include "storage/types/input_selection.h"
#include "storage/types/isovalue.h"
#include "storage/types/label_range.h"
#include "storage/types/material.h"
#include "storage/types/sample_type.h"
#include "storage/types/solid.h"

namespace voxweld {

// The order of the enumerators is the order of the names in settings_*.cpp.

// A side of any volume (see max_levels); of a mesh's lattice with margins, which are small.
inline constexpr std::int64_t most_samples = (std::int64_t{1} << 19) - 1;
inline constexpr std::int64_t least_resolution = 4, most_resolution = most_samples - 7;

// What becomes of a mesh that is not closed: it is refused, or has its sides told by its winding
// number.
enum class MeshClosing : std::uint8_t { no, winding };

struct InputConfig {
  enum class Endian : std::uint8_t { little, big };

  std::filesystem::path path;  // absolute; empty of empty space
  // A reader of the table in storage/readers, "mesh", "empty", or "auto": never of a mesh, which is
  // known by its name.
  std::string format = "auto";
  std::optional<Box3> crop;     // samples, half-open; empty: the whole volume
  std::optional<Vec3> spacing;  // overrides the file's, in the volume's unit
  std::string unit;             // overrides the file's; empty: as the file says
  // The layout of raw samples: size and type are both set or both empty, set when format is raw.
  // Of empty space the size alone is set.
  std::optional<Index3> size;
  std::optional<SampleType> type;
  Endian endian = Endian::little;
  std::int64_t header_bytes = 0;
  InputSelection select{};  // of several volumes in a file
  Resample resample = Resample::none;
  bool follow = false;  // headers may name data files outside their folder
  // How finely a mesh is sampled: one of the two of a mesh, else none.
  std::optional<std::int64_t> resolution{};  // cells along the longest side of its box
  std::optional<double> cell{};              // the spacing, in the mesh's own unit
  std::int64_t margin = 1;  // whole cells of empty space around it, and half of one
  MeshClosing close = MeshClosing::no;

  // Else all of the surface is made by solids.
  bool has_samples() const { return !is_empty() && !is_mesh(); }
  bool is_empty() const { return format == "empty"; }
  bool is_mesh() const { return format == "mesh"; }

  friend bool operator==(const InputConfig&, const InputConfig&) = default;
};

struct WorkConfig {
  enum class Copy : std::uint8_t { automatic, always, never };

  std::filesystem::path directory;  // absolute
  std::int64_t chunk = 32;          // samples a side, divides brick * shard
  std::int64_t brick = 64;          // cells a side
  std::int64_t shard = 4;           // bricks a side
  Copy copy = Copy::automatic;

  friend bool operator==(const WorkConfig&, const WorkConfig&) = default;
};

// One isovalue of several.
struct IsovalueChoice {
  std::optional<Isovalue> value;  // empty: by the rule
  IsovalueRule rule = IsovalueRule::otsu;
  friend bool operator==(const IsovalueChoice&, const IsovalueChoice&) = default;
};

struct SurfaceConfig {
  enum class Inside : std::uint8_t { above, below };
  enum class Border : std::uint8_t { closed, open };
  enum class Gradient : std::uint8_t { automatic, subcell, eno, central };

  // Of a label volume, the value whose surface is asked for; isovalue is then the same number.
  std::optional<std::uint64_t> label{};
  // Of the file's real values. Empty: chosen from the volume's histogram by the rule.
  std::optional<Isovalue> isovalue;
  IsovalueRule isovalue_rule = IsovalueRule::otsu;  // of an empty isovalue; else otsu
  // A list of isovalues, a surface each: surfaces_of() makes configs with one of it. isovalue is
  // empty then.
  std::vector<IsovalueChoice> isovalues{};
  Inside inside = Inside::above;
  Border border = Border::closed;
  Gradient gradient = Gradient::automatic;
  // Of Gradient::automatic: the standard deviation of the samples as stored, measured. No setting.
  std::optional<double> noise{};

  friend bool operator==(const SurfaceConfig&, const SurfaceConfig&) = default;
};

struct LabelsConfig {
  enum class Select : std::uint8_t { all, mapped, listed };

  LabelMode mode = LabelMode::off;
  Select select = Select::all;
  std::vector<LabelRange> selected;  // ascending, apart; empty unless select is `listed`
  // Left out unless select is `listed`; ascending, apart.
  std::vector<LabelRange> background = {{0, 0}};
  std::filesystem::path map;                    // absolute; empty: none
  std::int64_t min_voxels = 0, max_voxels = 0;  // of a material; 0: no limit

  friend bool operator==(const LabelsConfig&, const LabelsConfig&) = default;
};

struct SimplifyConfig {
  enum class Unit : std::uint8_t { voxel, physical };
  enum class Metric : std::uint8_t { rms, sum };
  enum class Topology : std::uint8_t { manifold, safe, free };
  enum class Qef : std::uint8_t { qr, normal };
  enum class Refine : std::uint8_t { automatic, off, repair, collapse };
  enum class Intersections : std::uint8_t { none, report, ignore };

  bool enabled = true;
  double tolerance = 0.1;  // in tolerance_unit; a voxel is the smallest spacing
  Unit tolerance_unit = Unit::voxel;
  Metric metric = Metric::rms;
  Topology topology = Topology::manifold;
  Qef qef = Qef::qr;
  Refine refine = Refine::automatic;
  Intersections intersections = Intersections::none;
  // How many triangles are to be left, or which part; one of the two at most.
  std::optional<std::int64_t> triangles = {};
  std::optional<double> ratio = {};

  friend bool operator==(const SimplifyConfig&, const SimplifyConfig&) = default;
};

struct OutputConfig {
  enum class Merged : std::uint8_t { automatic, always, never };

  std::filesystem::path directory;  // absolute
  std::vector<std::string> formats = {"drc",
                                      "glb"};  // by name, as listed; not empty, no duplicates
  Merged merged = Merged::automatic;
  bool tiles = true;               // false only where merged is not `never`
  std::int64_t tile_vertices = 0;  // 0: 250000, fewer with levels, shared labels or little memory
  // No setting: of the tiles that merge plans, where refine makes others of them; 0: tile_vertices.
  std::int64_t planned_vertices = 0;
  std::int64_t levels = 1;  // of detail, the mesh itself among them; 0: as many as there are
  double precision = 0.01;  // voxels (the smallest spacing)
  bool normals = true;
  bool report = true;  // a page about the run, beside the manifest

  friend bool operator==(const OutputConfig&, const OutputConfig&) = default;
};

struct RunConfig {
  enum class Executor : std::uint8_t { local, slurm };

  Executor executor = Executor::local;
  std::int64_t threads = 0;                       // 0: as many as the machine has
  std::uint64_t memory = std::uint64_t{4} << 30;  // bytes a process, peak

  friend bool operator==(const RunConfig&, const RunConfig&) = default;
};

// How the tasks of run.executor = "slurm" are submitted.
struct SlurmConfig {
  std::string partition, account, qos;  // empty: the cluster's default
  std::string time = "4:00:00";         // of one task, in one of the forms `sbatch --time` takes
  std::int64_t cpus_per_task = 4;
  std::uint64_t mem = 0;              // bytes a task; 0: "auto", run.memory and a margin
  std::int64_t max_array = 1000;      // tasks of one job array
  std::int64_t max_running = 0;       // tasks at once; 0: as many as the cluster starts
  std::int64_t shards_per_task = 0;   // 0: "auto"
  std::int64_t retries = 3;           // how often a lost or failed task is submitted again
  std::vector<std::string> extra;     // options of sbatch, each as it stands after #SBATCH
  std::vector<std::string> prologue;  // shell lines before the task's command

  friend bool operator==(const SlurmConfig&, const SlurmConfig&) = default;
};

// One [[edit]]: a solid that is added to the material, taken from it, or all that is kept of it.
// What its shape does not take is as it is here.
struct EditConfig {
  EditOp op = EditOp::add;
  SolidShape shape = SolidShape::sphere;
  Vec3 center = {};                         // lengths in output units, spacing * sample index
  double radius = 0, height = 0, tube = 0;  // above 0 where the shape takes them, tube <= radius
  Vec3 size = {};                           // full side lengths
  Vec3 axis = {0, 0, 1};                    // of any length but 0
  Vec3 rotate = {};                         // degrees about x, then y, then z
  std::filesystem::path path = {};          // absolute
  double scale = 1;                         // above 0
  std::optional<std::uint64_t> material{};  // of label volumes
  MeshClosing close = MeshClosing::no;

  friend bool operator==(const EditConfig&, const EditConfig&) = default;
};

enum class FilterType : std::uint8_t {
  window,
  gaussian,
  mean,
  median,
  downsample,
  flip,
  permute,
  mask,
  keep,
  fill
};

// One [[filter]]: what happens to the samples between the file and the surface. What its type does
// not take is as it is here. Lengths are in samples, values are real ones.
struct FilterConfig {
  enum class Method : std::uint8_t { mean, max, mode };

  FilterType type = FilterType::window;
  std::array<double, 2> clip = {};               // window: lo < hi
  std::optional<std::array<double, 2>> scale{};  // window: where clip goes; two numbers apart
  std::optional<SampleType> sample_type{};       // of the result; empty: as it was
  Vec3 sigma = {};                               // gaussian: at least one above 0
  Index3 radius = {1, 1, 1};                     // mean, median: at least one above 0
  Index3 factor = {2, 2, 2};                     // downsample: at least one above 1
  Method method = Method::mean;                  // downsample
  std::array<bool, 3> flipped = {};              // flip: axes x, y, z
  std::array<int, 3> order = {0, 1, 2};          // permute: axis a was axis order[a]
  std::filesystem::path path = {};               // mask; absolute
  std::vector<LabelRange> values = {};           // mask: ascending, apart; empty: all but 0
  std::optional<double> outside{}, inside{};     // mask and keep; fill: what samples become
  std::int64_t min_voxels = 0;                   // keep; 0: the largest piece alone
  std::int64_t max_voxels = 0;                   // fill; above 0

  // Whether it needs the whole volume before it gives one sample.
  bool is_global() const { return type == FilterType::keep || type == FilterType::fill; }

  friend bool operator==(const FilterConfig&, const FilterConfig&) = default;
};

struct Config {
  InputConfig input;
  WorkConfig work;
  SurfaceConfig surface;
  LabelsConfig labels;
  SimplifyConfig simplify;
  OutputConfig output;
  RunConfig run;
  SlurmConfig slurm;
  std::vector<FilterConfig> filters;  // applied in this order
  std::vector<EditConfig> edits;      // applied in this order, after all filters

  friend bool operator==(const Config&, const Config&) = default;
};

// Whether the tolerance of refine is found, so that a number of triangles is left.
inline bool has_target(const Config& config) {
  return config.simplify.triangles || config.simplify.ratio;
}

// What is done to the stitched mesh, never `automatic`. Left open it is `collapse` where cells are
// collapsed too, and keep the topology: of these meshes alone no two triangles have to cut each other.
inline SimplifyConfig::Refine refine_mode(const Config& config) {
  using Simplify = SimplifyConfig;
  if (config.simplify.refine != Simplify::Refine::automatic) return config.simplify.refine;
  return config.simplify.enabled && config.simplify.topology != Simplify::Topology::free
             ? Simplify::Refine::collapse
             : Simplify::Refine::off;
}

// Whether each sheet of the surface collapses by itself. Where several labels meet there are no
// sheets to tell apart.
inline bool collapses_by_sheets(const Config& config) {
  return config.simplify.enabled &&
         config.simplify.topology == SimplifyConfig::Topology::manifold &&
         config.labels.mode != LabelMode::shared;
}

// Whether samples are labels, and not compared with an isovalue.
inline bool is_of_labels(const Config& config) {
  return config.surface.label || config.labels.mode != LabelMode::off;
}

// How many cells a vertex may leave its own by where edges are collapsed afterwards. Along creases that meet
// at small angles planes of one cell meet some cells away. Between labels none: their surfaces have no sharp
// edges, and it made 8 % more triangles of the liver (tolerance 0.1).
inline double vertex_overhang(const Config& config) {
  return refine_mode(config) != SimplifyConfig::Refine::collapse || is_of_labels(config) ? 0 : 3;
}

// Reads the TOML file at `path`, then applies `overrides` in order, each "table.key=value": the
// value is TOML, bare words are strings ("surface.isovalue=otsu"). Relative paths are relative to
// the file's folder, those in overrides to the current directory.
// Throws InputError, naming file:line:column (or the override), the key, what is accepted and what
// was found; StorageError when the file exists but cannot be read.
Config load_config(const std::filesystem::path& path, std::span<const std::string> overrides = {});

// The text of a config file, as load_config() reads it.
std::string read_config_text(const std::filesystem::path& path);

// The same as load_config() for a text already at hand; `path` is the file it stands for (names it
// in messages, gives the folder of relative paths and the default directories) and need not exist.
Config parse_config(const std::string& text, const std::filesystem::path& path,
                    std::span<const std::string> overrides = {});

// The effective config as TOML: every key that has a value, in the order of the table, paths
// absolute. Reading it back gives an equal config.
std::string canonical_toml(const Config& config);

// Equal for equal configs. Over every key, those that cannot change a result included: to see
// whether anything was edited. What decides the bytes of a stage is parameter_hash().
Hash128 config_fingerprint(const Config& config);

struct OneSurface {
  std::string isovalue;  // "300", "otsu": what it is called; empty: the config has no list
  Config config;
};

// The configs of the surfaces that a list of isovalues asks for, in its order. They differ in
// surface.isovalue, and write into folders of output.directory: "isovalue-300". Of a config without
// a list, itself.
std::vector<OneSurface> surfaces_of(const Config& config);

// Equal for configs that give the same meshes of the same files, wherever they are written.
Hash128 result_hash(const Config& config);

}  // namespace voxweld
