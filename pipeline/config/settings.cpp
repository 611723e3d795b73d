#include "pipeline/config/settings.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace voxweld {
namespace {

constexpr std::int64_t no_limit = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t most_samples = (std::int64_t{1} << 19) - 1;  // a side; see max_levels

// How a member of Config is read from and written to a value: the rule says which values come.
struct Binding {
  Rule rule;
  std::function<void(Config&, const ConfigValue&)> set;
  std::function<std::optional<ConfigValue>(const Config&)> get;
};

template <class Group, class T>
using Field = std::pair<Group Config::*, T Group::*>;

template <class T, class Group>
T& at(Config& config, const Field<Group, T>& field) {
  return (config.*field.first).*field.second;
}
template <class T, class Group>
const T& at(const Config& config, const Field<Group, T>& field) {
  return (config.*field.first).*field.second;
}

std::size_t index_of(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

template <class Group>
Binding path(Group Config::*group, std::filesystem::path Group::*member) {
  const Field<Group, std::filesystem::path> field{group, member};
  return {PathRule{}, [=](Config& c, const ConfigValue& v) { at(c, field) = *v.text(); },
          [=](const Config& c) -> std::optional<ConfigValue> {
            if (at(c, field).empty()) return std::nullopt;
            return ConfigValue{at(c, field).string()};
          }};
}

// names[i] is the name of the enumerator i.
template <class Group, class Enum>
Binding choice(Group Config::*group, Enum Group::*member, std::vector<std::string> names) {
  const Field<Group, Enum> field{group, member};
  return {ChoiceRule{names},
          [=](Config& c, const ConfigValue& v) {
            at(c, field) = static_cast<Enum>(index_of(names, *v.text()));
          },
          [=](const Config& c) -> std::optional<ConfigValue> {
            return ConfigValue{names[static_cast<std::size_t>(at(c, field))]};
          }};
}

template <class Group, class Enum>
Binding choices(Group Config::*group, std::vector<Enum> Group::*member,
                std::vector<std::string> names) {
  const Field<Group, std::vector<Enum>> field{group, member};
  return {ChoiceListRule{names},
          [=](Config& c, const ConfigValue& v) {
            at(c, field).clear();
            for (const ConfigValue& item : *v.list())
              at(c, field).push_back(static_cast<Enum>(index_of(names, *item.text())));
            // What is written does not depend on the order it was asked for in.
            std::sort(at(c, field).begin(), at(c, field).end());
          },
          [=](const Config& c) -> std::optional<ConfigValue> {
            ConfigValue::List list;
            for (const Enum item : at(c, field))
              list.push_back({names[static_cast<std::size_t>(item)]});
            return ConfigValue{std::move(list)};
          }};
}

// Enumerators in the order automatic, always, never.
template <class Group, class Enum>
Binding switch_of(Group Config::*group, Enum Group::*member) {
  const Field<Group, Enum> field{group, member};
  return {SwitchRule{},
          [=](Config& c, const ConfigValue& v) {
            at(c, field) = v.flag() == nullptr ? Enum::automatic
                           : *v.flag()         ? Enum::always
                                               : Enum::never;
          },
          [=](const Config& c) -> std::optional<ConfigValue> {
            if (at(c, field) == Enum::automatic) return ConfigValue{std::string("auto")};
            return ConfigValue{at(c, field) == Enum::always};
          }};
}

template <class Group>
Binding flag(Group Config::*group, bool Group::*member) {
  const Field<Group, bool> field{group, member};
  return {FlagRule{}, [=](Config& c, const ConfigValue& v) { at(c, field) = *v.flag(); },
          [=](const Config& c) -> std::optional<ConfigValue> { return ConfigValue{at(c, field)}; }};
}

template <class Group>
Binding integer(Group Config::*group, std::int64_t Group::*member, Rule rule) {
  const Field<Group, std::int64_t> field{group, member};
  return {std::move(rule), [=](Config& c, const ConfigValue& v) { at(c, field) = *v.integer(); },
          [=](const Config& c) -> std::optional<ConfigValue> { return ConfigValue{at(c, field)}; }};
}

template <class Group>
Binding positive(Group Config::*group, double Group::*member) {
  const Field<Group, double> field{group, member};
  return {PositiveNumberRule{}, [=](Config& c, const ConfigValue& v) { at(c, field) = v.number(); },
          [=](const Config& c) -> std::optional<ConfigValue> { return ConfigValue{at(c, field)}; }};
}

Binding crop() {
  return {IntegerListRule{6, 0, most_samples},
          [](Config& c, const ConfigValue& v) {
            const auto& list = *v.list();
            Box3 box;
            for (int axis = 0; axis < 3; ++axis) {
              box.lo[axis] = *list[static_cast<std::size_t>(axis)].integer();
              box.hi[axis] = *list[static_cast<std::size_t>(axis) + 3].integer();
            }
            c.input.crop = box;
          },
          [](const Config& c) -> std::optional<ConfigValue> {
            if (!c.input.crop) return std::nullopt;
            const Box3& box = *c.input.crop;
            return ConfigValue{ConfigValue::List{
                {box.lo.x}, {box.lo.y}, {box.lo.z}, {box.hi.x}, {box.hi.y}, {box.hi.z}}};
          }};
}

Binding spacing() {
  return {SpacingRule{},
          [](Config& c, const ConfigValue& v) {
            const auto* list = v.list();
            if (list == nullptr)
              c.input.spacing = Vec3{v.number(), v.number(), v.number()};
            else
              c.input.spacing = Vec3{(*list)[0].number(), (*list)[1].number(), (*list)[2].number()};
          },
          [](const Config& c) -> std::optional<ConfigValue> {
            if (!c.input.spacing) return std::nullopt;
            const Vec3 s = *c.input.spacing;
            return ConfigValue{ConfigValue::List{{s.x}, {s.y}, {s.z}}};
          }};
}

Binding unit() {
  return {ChoiceRule{{"m", "cm", "mm", "um", "nm", "angstrom"}},
          [](Config& c, const ConfigValue& v) { c.input.unit = *v.text(); },
          [](const Config& c) -> std::optional<ConfigValue> {
            if (c.input.unit.empty()) return std::nullopt;
            return ConfigValue{c.input.unit};
          }};
}

Binding raw_size() {
  return {IntegerListRule{3, 1, most_samples},
          [](Config& c, const ConfigValue& v) {
            const auto& list = *v.list();
            c.input.size = Index3{*list[0].integer(), *list[1].integer(), *list[2].integer()};
          },
          [](const Config& c) -> std::optional<ConfigValue> {
            if (!c.input.size) return std::nullopt;
            const Index3 s = *c.input.size;
            return ConfigValue{ConfigValue::List{{s.x}, {s.y}, {s.z}}};
          }};
}

Binding raw_type() {
  ChoiceRule rule;
  for (int i = 0; i <= static_cast<int>(SampleType::f64); ++i)
    rule.names.emplace_back(sample_type_name(static_cast<SampleType>(i)));
  return {std::move(rule),
          [](Config& c, const ConfigValue& v) { c.input.type = parse_sample_type(*v.text()); },
          [](const Config& c) -> std::optional<ConfigValue> {
            if (!c.input.type) return std::nullopt;
            return ConfigValue{std::string(sample_type_name(*c.input.type))};
          }};
}

Binding isovalue() {
  return {NumberOrWordRule{"otsu"},
          [](Config& c, const ConfigValue& v) {
            c.surface.isovalue = v.is_number() ? std::optional(v.number()) : std::nullopt;
          },
          [](const Config& c) -> std::optional<ConfigValue> {
            if (!c.surface.isovalue) return ConfigValue{std::string("otsu")};
            return ConfigValue{*c.surface.isovalue};
          }};
}

Binding memory() {
  return {MemoryRule{std::uint64_t{64} << 20},
          [](Config& c, const ConfigValue& v) {
            c.run.memory = v.text() != nullptr ? *parse_bytes(*v.text())
                                               : static_cast<std::uint64_t>(*v.integer());
          },
          [](const Config& c) -> std::optional<ConfigValue> {
            return ConfigValue{bytes_text(c.run.memory)};
          }};
}

using Stages = std::vector<Stage>;
const Stages none = {};
const Stages ingest = {Stage::ingest};
const Stages build = {Stage::build};
const Stages merge = {Stage::merge};
const Stages stitch = {Stage::stitch};
const Stages encode = {Stage::encode};
// The layout of raw samples: what ingest copies, and what build reads where there is no copy.
const Stages samples = {Stage::ingest, Stage::build};
// Merge goes on collapsing above the bricks by the rules of build. Root records need not change
// with them (a higher tolerance may leave every brick as it was), so merge's key names them too.
const Stages collapse = {Stage::build, Stage::merge};
// Octrees and root records are relative to the cell, so their bytes need not change with the
// spacing; the lengths merge and stitch work with do.
const Stages lengths = {Stage::ingest, Stage::build, Stage::merge, Stage::stitch};
// The open result is the closed one less some polygons, and those are made in stitch.
const Stages border = {Stage::build, Stage::stitch};

struct Words {
  const char* table;
  const char* key;
  const char* description;
  const char* default_note = "";
};

Setting row(Words words, Binding binding, Stages stages) {
  Setting setting;
  setting.table = words.table;
  setting.key = words.key;
  setting.rule = std::move(binding.rule);
  setting.stages = std::move(stages);
  setting.description = words.description;
  setting.default_note = words.default_note;
  setting.set = std::move(binding.set);
  setting.get = std::move(binding.get);
  return setting;
}

Setting required(Setting setting) {
  setting.required = true;
  setting.default_note = "required";
  return setting;
}

std::vector<Setting> input_settings() {
  using In = InputConfig;
  constexpr auto in = &Config::input;
  return {
      // What the file holds is in the keys by content, so moving it re-runs nothing.
      required(row({"input", "path", "The volume: a file, a directory of slices or a Zarr array."},
                   path(in, &In::path), none)),
      row({"input", "format", "How to read it. \"auto\" goes by the content and the name."},
          choice(in, &In::format, {"auto", "nrrd", "metaimage", "nifti", "raw", "stack", "zarr"}),
          ingest),
      row({"input", "crop", "The box of samples to use, half-open: [x0, y0, z0, x1, y1, z1].",
           "the whole volume"},
          crop(), samples),
      row({"input", "spacing",
           "Distance of neighbouring samples: one number or [x, y, z]. Overrides the file's.",
           "as the file says, else 1"},
          spacing(), lengths),
      row({"input", "unit", "Unit of the spacing. Overrides the file's.", "as the file says"},
          unit(), {Stage::ingest, Stage::encode}),
      row({"input", "size", "Raw only: samples along [x, y, z], x fastest in the file.",
           "needed when the format is raw"},
          raw_size(), samples),
      row({"input", "type", "Raw only: type of a sample.", "needed when the format is raw"},
          raw_type(), samples),
      row({"input", "endian", "Raw only: byte order of a sample."},
          choice(in, &In::endian, {"little", "big"}), samples),
      row({"input", "header_bytes", "Raw only: bytes before the first sample."},
          integer(in, &In::header_bytes, IntegerRule{0, no_limit}), samples),
  };
}

std::vector<Setting> work_settings() {
  using Work = WorkConfig;
  constexpr auto work = &Config::work;
  return {
      row({"work", "directory",
           "Where intermediate files and finished work are kept, to resume from.",
           "\"<config name>.work\" beside the config"},
          path(work, &Work::directory), none),
      row({"work", "chunk",
           "Samples a side of the brick store's chunks. At most brick * shard. Never changes the "
           "result."},
          integer(work, &Work::chunk, PowerOfTwoRule{8, 256}), ingest),
      row({"work", "brick", "Cells a side of one octree piece. Never changes the result."},
          integer(work, &Work::brick, PowerOfTwoRule{16, 256}), samples),
      row({"work", "shard",
           "Bricks a side of one store file and one build task. Never changes the result."},
          integer(work, &Work::shard, PowerOfTwoRule{1, 16}), samples),
      row({"work", "copy",
           "Copy the samples into the brick store first. \"auto\" copies only inputs that cannot "
           "be read in boxes."},
          switch_of(work, &Work::copy), none),
  };
}

std::vector<Setting> surface_settings() {
  using Surface = SurfaceConfig;
  constexpr auto surface = &Config::surface;
  return {
      required(row({"surface", "isovalue",
                    "The sample value the surface runs through; \"otsu\" chooses it from the "
                    "histogram."},
                   isovalue(), build)),
      row({"surface", "inside", "Which side of the isovalue is material. Equal is inside."},
          choice(surface, &Surface::inside, {"above", "below"}), build),
      row({"surface", "border",
           "\"closed\" caps material that reaches the volume's border; \"open\" leaves it open."},
          choice(surface, &Surface::border, {"closed", "open"}), border),
      row({"surface", "gradient",
           "How normals are estimated: \"eno\" keeps sharp features, \"central\" blurs noise."},
          choice(surface, &Surface::gradient, {"eno", "central"}), build),
  };
}

std::vector<Setting> simplify_settings() {
  using Simplify = SimplifyConfig;
  constexpr auto simplify = &Config::simplify;
  return {
      row({"simplify", "enabled", "Collapse cells where the surface allows it."},
          flag(simplify, &Simplify::enabled), collapse),
      row({"simplify", "tolerance", "How far a vertex may be from the surface it stands for."},
          positive(simplify, &Simplify::tolerance), collapse),
      row({"simplify", "tolerance_unit",
           "\"voxel\": in smallest spacings; \"physical\": in the spacing's unit."},
          choice(simplify, &Simplify::tolerance_unit, {"voxel", "physical"}), collapse),
      row({"simplify", "metric",
           "\"rms\": root mean square of the distances; \"sum\": root of their summed squares, "
           "so each is within tolerance."},
          choice(simplify, &Simplify::metric, {"rms", "sum"}), collapse),
      row({"simplify", "topology",
           "\"safe\" keeps the surface's topology; \"free\" lets it change and promises no "
           "manifold."},
          choice(simplify, &Simplify::topology, {"safe", "free"}), collapse),
      row({"simplify", "qef",
           "\"qr\": stable in floats; \"normal\": the normal equations, for comparison only."},
          choice(simplify, &Simplify::qef, {"qr", "normal"}), collapse),
  };
}

std::vector<Setting> output_settings() {
  using Output = OutputConfig;
  constexpr auto output = &Config::output;
  return {
      row({"output", "directory", "Where the meshes and the manifest go.",
           "\"<config name>.mesh\" beside the config"},
          path(output, &Output::directory), none),
      row({"output", "formats", "The file formats to write."},
          choices(output, &Output::formats, {"drc", "glb"}), encode),
      row({"output", "merged",
           "Also write the whole mesh as one file. \"auto\" does where it is small enough."},
          switch_of(output, &Output::merged), encode),
      row({"output", "tiles", "Write the tiles as files of their own."},
          flag(output, &Output::tiles), encode),
      row({"output", "tile_vertices", "The most vertices a tile may have."},
          integer(output, &Output::tile_vertices, IntegerRule{1024, 1000000000}), merge),
      row({"output", "precision",
           "The step coordinates are rounded to, at most, in smallest spacings."},
          positive(output, &Output::precision), stitch),
      row({"output", "normals", "Write normals."}, flag(output, &Output::normals), stitch),
  };
}

std::vector<Setting> run_settings() {
  using Run = RunConfig;
  constexpr auto run = &Config::run;
  return {
      row({"run", "executor", "Where the work runs."}, choice(run, &Run::executor, {"local"}),
          none),
      row({"run", "threads", "Threads to use; 0: as many as the machine has."},
          integer(run, &Run::threads, IntegerRule{0, 4096}), none),
      row({"run", "memory", "The most memory a process may use."}, memory(), none),
  };
}

std::vector<Setting> make_settings() {
  std::vector<Setting> all;
  for (auto make : {input_settings, work_settings, surface_settings, simplify_settings,
                    output_settings, run_settings})
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
  return std::find(stages.begin(), stages.end(), stage) != stages.end();
}

std::string Setting::default_text() const {
  if (!default_note.empty()) return default_note;
  const auto value = get(Config{});
  return value ? to_toml(*value) : "";
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
  if (table == "simplify") return "How far to simplify it.";
  if (table == "output") return "What to write.";
  return "What the run may use. Never changes the result.";
}

}  // namespace voxweld
