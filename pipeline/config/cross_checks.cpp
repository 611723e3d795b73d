#include "pipeline/config/cross_checks.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "pipeline/config/filter_settings.h"
#include "pipeline/config/settings.h"
#include "stages/encode/mesh_writers.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// The checks that look at several settings. `where` is the place of the first of the named keys
// that was given.
class CrossChecks {
 public:
  CrossChecks(const Config& config, const Places& places, std::string file)
      : config_(config), places_(places), file_(std::move(file)) {}

  void required() const {
    // Empty space is neither read nor cut by an isovalue, and a mesh has its surface.
    if (config_.input.is_empty()) return;
    const bool mesh = config_.input.is_mesh();
    for (const Setting& setting : settings())
      if (setting.required && !places_.contains(setting.name()) &&
          !((has_labels() || mesh) && setting.name() == "surface.isovalue"))
        throw InputError(fmt::format("{}: missing key {} (expected {}): {}", file_, setting.name(),
                                     accepted_text(setting.rule), setting.description));
  }

  void crop() const {
    if (!config_.input.crop || !config_.input.crop->empty()) return;
    fail({"input.crop"}, "expected [x0, y0, z0, x1, y1, z1] with x0 < x1, y0 < y1 and z0 < z1");
  }

  void raw() const {
    const InputConfig& in = config_.input;
    if (!in.has_samples()) return;
    if (in.format != "raw" && in.format != "auto")
      refuse({"input.size", "input.type", "input.endian", "input.header_bytes"},
             "only raw files take it; remove it, or set input.format = \"raw\"");
    const bool needed = in.format == "raw" || in.size || in.type;
    constexpr const char* missing = "missing, and raw files need it: expected ";
    if (needed && !in.size)
      fail({"input.size", "input.format", "input.type"}, missing + accepted("input.size"));
    if (needed && !in.type)
      fail({"input.type", "input.format", "input.size"}, missing + accepted("input.type"));
  }

  void empty() const {
    const InputConfig& in = config_.input;
    if (!in.is_empty()) return;
    refuse({"input.path", "input.crop", "input.type", "input.endian", "input.header_bytes",
            "input.follow", "input.dataset", "input.series", "input.level", "input.channel",
            "input.time", "input.resample"},
           "empty space has no file; remove it, or input.format = \"empty\"");
    if (!in.size)
      fail({"input.size", "input.format"},
           "missing, and empty space needs it: expected " + accepted("input.size"));
    if (config_.edits.empty())
      fail({"input.format"}, "empty space and no edits have no surface; add [[edit]] tables");
  }

  void mesh() const {
    const InputConfig& in = config_.input;
    if (!in.is_mesh())
      return refuse({"input.resolution", "input.cell", "input.margin", "input.close"},
                    "only meshes take it; remove it, or name an .stl, .off, .obj or .ply");
    refuse({"input.crop", "input.spacing", "input.size", "input.type", "input.endian",
            "input.header_bytes", "input.follow", "input.dataset", "input.series", "input.level",
            "input.channel", "input.time", "input.resample"},
           "a mesh has no samples; remove it: input.resolution or input.cell says how "
           "finely it is sampled");
    if (in.resolution && in.cell)
      fail({"input.resolution", "input.cell"},
           "input.cell says the same in another way; remove one of the two");
    if (!in.resolution && !in.cell)
      fail({"input.resolution", "input.path", "input.format"},
           "missing, and a mesh needs it, or input.cell: expected " + accepted("input.resolution"));
    constexpr const char* own = "a mesh is its own surface, with its own normals; remove it";
    if (places_.contains("surface.isovalue")) fail({"surface.isovalue"}, own);
    refuse({"surface.label", "surface.inside", "surface.gradient"}, own);
  }

  void label() const {
    const SurfaceConfig& surface = config_.surface;
    if (!surface.label) return;
    const Isovalue number = Isovalue::of(*surface.label);
    if (surface.isovalue && *surface.isovalue != number)
      fail({"surface.isovalue"}, "a label has no isovalue; remove this one, or surface.label");
    if (surface.inside == SurfaceConfig::Inside::below)
      fail({"surface.inside"}, "inside are the samples of surface.label; remove one of the two");
  }

  void isovalues() const {
    if (config_.surface.isovalues.empty()) return;
    constexpr const char* samples = "a list of isovalues is for samples; remove it, or ";
    if (config_.surface.label) fail({"surface.isovalue"}, std::string(samples) + "surface.label");
    if (config_.labels.mode != LabelMode::off)
      fail({"surface.isovalue"}, std::string(samples) + "labels.mode");
    if (config_.input.is_empty())
      fail({"surface.isovalue"}, std::string(samples) + "input.format = \"empty\"");
  }

  void labels() const {
    const SurfaceConfig& surface = config_.surface;
    if (config_.labels.mode == LabelMode::off) return;
    if (config_.input.is_mesh())
      fail({"labels.mode", "input.path"},
           "a mesh has no labels; for solids of several, give empty space and [[edit]] tables of "
           "shape mesh");
    if (surface.label)
      fail({"surface.label", "labels.mode"}, "labels.mode chooses labels too; remove one of them");
    if (surface.inside == SurfaceConfig::Inside::below)
      fail({"surface.inside", "labels.mode"}, "labels have no isovalue; remove this key");
    if (config_.simplify.topology == SimplifyConfig::Topology::free)
      fail({"simplify.topology", "labels.mode"},
           "labels keep their topology; set it to \"manifold\" or \"safe\", or remove this key");
    if (config_.labels.mode == LabelMode::each) each();
    if (config_.labels.mode == LabelMode::shared) shared();
  }

  void shared() const {
    for (const MeshWriter& format : writers_named(mesh_writers(), config_.output.formats))
      if (!format.holds_labels)
        fail({"output.formats", "labels.mode"},
             fmt::format("\"{}\" has no place for the labels that triangles of labels.mode = "
                         "\"shared\" separate; remove it, or set labels.mode = \"each\"",
                         format.name));
  }

  // The meshes of neighbouring labels overlap: they are no one mesh.
  void each() const {
    if (config_.output.merged == OutputConfig::Merged::always)
      fail({"output.merged", "labels.mode"},
           "labels.mode = \"each\" writes a mesh for each label and none of all; remove this key");
    if (!config_.output.tiles)
      fail({"output.tiles", "labels.mode"},
           "labels.mode = \"each\" has no other meshes to write; remove this key");
  }

  void refine() const {
    const SimplifyConfig& simplify = config_.simplify;
    for (const char* key : {"simplify.triangles", "simplify.ratio"})
      if (setting_of(key).get(config_) && refine_mode(config_) != SimplifyConfig::Refine::collapse)
        fail({key, "simplify.refine"},
             "only a mesh whose edges are collapsed can be brought to a number of triangles; set "
             "simplify.refine = \"collapse\", or remove this key");
    if (simplify.triangles && simplify.ratio)
      fail({"simplify.ratio", "simplify.triangles"},
           "simplify.triangles says the same in another way; remove one of the two");
    if (refine_mode(config_) == SimplifyConfig::Refine::off) return;
    if (simplify.topology == SimplifyConfig::Topology::free)
      fail({"simplify.refine", "simplify.topology"},
           "with simplify.topology = \"free\" the mesh is no manifold, and only those are refined; "
           "set one of the two to another value");
  }

  void chosen_labels() const {
    const LabelsConfig& labels = config_.labels;
    if (labels.select == LabelsConfig::Select::mapped && labels.map.empty())
      fail({"labels.select"}, "there is no labels.map that names labels; give one, or a list");
    if (labels.max_voxels != 0 && labels.min_voxels > labels.max_voxels)
      fail({"labels.min_voxels", "labels.max_voxels"},
           fmt::format("expected at most labels.max_voxels = {}; nothing would be left",
                       labels.max_voxels));
  }

  // Edits stand in the file alone, so they are named by their numbers.
  void edits_of_labels() const {
    const LabelMode mode = config_.labels.mode;
    const auto refuse_edit = [&](std::size_t number, const char* problem) {
      throw InputError(fmt::format("{}: edit {}: {}", file_, number, problem));
    };
    for (std::size_t i = 0; i < config_.edits.size(); ++i) {
      const EditConfig& edit = config_.edits[i];
      if (mode != LabelMode::off && gives_material(edit.op) && !edit.material)
        refuse_edit(i + 1, "material is missing: expected the label that the solid gets");
      if (mode == LabelMode::off && edit.op == EditOp::replace)
        refuse_edit(i + 1,
                    "op = \"replace\": there is one material, so nothing to replace; it is for "
                    "labels.mode = \"each\" and \"shared\"");
    }
  }

  void filters() const {
    for (std::size_t i = 0; i < config_.filters.size(); ++i) {
      const FilterConfig& filter = config_.filters[i];
      if (!config_.input.has_samples())
        fail_filter(i, config_.input.is_mesh() ? "a mesh has no samples to filter; remove it"
                                               : "empty space has no samples to filter; remove it");
      if (has_labels() && !keeps_labels(filter))
        fail_filter(i, fmt::format("{} makes no labels of labels; between labels and with "
                                   "surface.label take downsample with method = \"mode\", flip, "
                                   "permute or mask",
                                   filter_text(filter)));
      if (filter.type == FilterType::mask && !filter.outside && !has_labels())
        fail_filter(i,
                    "missing key outside: expected the real value that samples outside the "
                    "mask get, " +
                        accepted_text(filter_items().find("outside")->rule));
    }
  }

  void work() const {
    const WorkConfig& w = config_.work;
    if (w.chunk <= w.brick * w.shard) return;
    fail({"work.chunk", "work.shard", "work.brick"},
         fmt::format("expected at most work.brick * work.shard = {} * {} = {}, so that chunks "
                     "divide shards; lower work.chunk or raise work.brick or work.shard",
                     w.brick, w.shard, w.brick * w.shard));
  }

  void output() const {
    if (config_.output.tiles || config_.output.merged != OutputConfig::Merged::never) return;
    fail({"output.tiles", "output.merged"},
         "with output.merged = false there is nothing to write; set one of the two to true");
  }

  void levels() const {
    if (!has_levels(config_)) return;
    if (refine_mode(config_) == SimplifyConfig::Refine::off)
      fail({"output.levels", "simplify.refine"},
           "levels of detail are made of a mesh that is refined, and simplify.refine is \"off\" "
           "here; set it to \"repair\" or \"collapse\", or output.levels to 1");
    if (config_.labels.mode == LabelMode::each)
      for (const MeshWriter& format : writers_named(mesh_writers(), config_.output.formats))
        if (!format.holds_labels)
          fail({"output.formats", "output.levels"},
               fmt::format(
                   "coarser levels have many labels in one file, and \"{}\" has no place for "
                   "them; remove it, or set output.levels to 1",
                   format.name));
    if (!config_.output.tiles)
      fail({"output.levels", "output.tiles"},
           "levels of detail are tiles; set output.tiles to true, or output.levels to 1");
  }

  // What a run writes lies in no folder of the user's own files.
  void directories() const {
    const auto normal = [](const std::filesystem::path& path) {
      std::error_code ignored;
      const std::filesystem::path there = std::filesystem::weakly_canonical(path, ignored);
      return there.has_filename() ? there : there.parent_path();
    };
    const std::filesystem::path output = normal(config_.output.directory);
    if (output == normal(config_.work.directory))
      fail({"output.directory", "work.directory"},
           "is work.directory too, where intermediate files go; choose another directory");
    const std::filesystem::path& input = config_.input.path;
    if (input.empty() || (output != normal(input) && output != normal(input.parent_path()))) return;
    fail({"output.directory", "input.path"},
         "is the input's own folder, and meshes would lie among its files; choose a directory for "
         "them alone");
  }

  void slurm() const {
    const std::uint64_t mem = config_.slurm.mem;
    if (config_.run.executor != RunConfig::Executor::slurm || mem == 0) return;
    if (mem < config_.run.memory)
      fail({"slurm.mem", "run.memory"},
           fmt::format("expected at least run.memory = {}, which a task's process may use; raise "
                       "it, or leave it \"auto\"",
                       bytes_text(config_.run.memory)));
  }

 private:
  bool has_labels() const { return config_.surface.label || config_.labels.mode != LabelMode::off; }

  // Whether what it makes of labels are labels that were there, or outside.
  static bool keeps_labels(const FilterConfig& filter) {
    switch (filter.type) {
      case FilterType::flip:
      case FilterType::permute:
      case FilterType::mask:
        return true;
      case FilterType::downsample:
        return filter.method == FilterConfig::Method::mode;
      default:
        return false;
    }
  }
  static std::string filter_text(const FilterConfig& filter) {
    std::string text;
    for (const auto& value : filter_items().values_of(filter))
      if (value.setting->key == "type" || value.setting->key == "method")
        text += fmt::format("{}{} = {}", text.empty() ? "" : " with ", value.setting->key,
                            to_toml(value.value));
    return text;
  }
  [[noreturn]] void fail_filter(std::size_t index, const std::string& problem) const {
    const std::string name = fmt::format("{} {}", filter_table, index + 1);
    const auto place = places_.find(name);
    throw InputError(
        fmt::format("{}: {}: {}", place == places_.end() ? file_ : place->second, name, problem));
  }

  static const Setting& setting_of(const std::string& name) {
    const auto dot = name.find('.');
    return *find_setting(name.substr(0, dot), name.substr(dot + 1));
  }
  static std::string accepted(const std::string& name) {
    return accepted_text(setting_of(name).rule);
  }

  // Those of the names that are not at their defaults. Judged by value, not by presence: canonical
  // configs write the defaults of every key.
  void refuse(const std::vector<std::string>& names, const std::string& problem) const {
    for (const std::string& name : names) {
      const Setting& setting = setting_of(name);
      if (setting.get(config_) != setting.default_value) fail({name}, problem);
    }
  }

  // The message is about the first name.
  [[noreturn]] void fail(const std::vector<std::string>& names, const std::string& problem) const {
    std::string where = file_;
    for (auto name = names.rbegin(); name != names.rend(); ++name)
      if (const auto found = places_.find(*name); found != places_.end()) where = found->second;
    const auto value = setting_of(names[0]).get(config_);
    throw InputError(fmt::format("{}: {}{}: {}", where, names[0],
                                 value ? " = " + to_toml(*value) : std::string(), problem));
  }

  const Config& config_;
  const Places& places_;
  std::string file_;
};

}  // namespace

void check_across(const Config& config, const Places& places, const std::string& file) {
  const CrossChecks checks(config, places, file);
  checks.required();
  checks.crop();
  checks.raw();
  checks.empty();
  checks.mesh();
  checks.isovalues();
  checks.label();
  checks.labels();
  checks.refine();
  checks.chosen_labels();
  checks.filters();
  checks.edits_of_labels();
  checks.work();
  checks.output();
  checks.levels();
  checks.directories();
  checks.slurm();
}

}  // namespace voxweld
