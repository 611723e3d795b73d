#include "pipeline/config/binding.h"

#include <cstdint>

#include "pipeline/config/label_list.h"
#include "stages/encode/mesh_writers.h"
#include "storage/readers/open_volume.h"

namespace voxweld::binding {

void Form::read(Value v, Texts& out) {
  out.clear();
  for (const ConfigValue& item : *v.list()) out.push_back(*item.text());
}

void Form::read(Value v, Pair& out) {
  out = {v.list()->front().number(), v.list()->back().number()};
}

void Form::read(Value v, Index3& out) {
  for (int axis = 0; axis < 3; ++axis)
    out[axis] = *(v.list() == nullptr ? v : (*v.list())[static_cast<std::size_t>(axis)]).integer();
}

void Form::read(Value v, Vec3& out) {
  for (int axis = 0; axis < 3; ++axis)
    out[axis] =
        v.list() == nullptr ? v.number() : (*v.list())[static_cast<std::size_t>(axis)].number();
}

void Form::read(Value v, Box3& out) {
  const ConfigValue::List& list = *v.list();
  read(ConfigValue{ConfigValue::List(list.begin(), list.begin() + 3)}, out.lo);
  read(ConfigValue{ConfigValue::List(list.begin() + 3, list.end())}, out.hi);
}

Written Form::written(const Path& v) {
  return v.empty() ? std::nullopt : written(v.string());
}

Written Form::written(const Texts& v) {
  ConfigValue::List list;
  for (const std::string& item : v) list.push_back({item});
  return ConfigValue{std::move(list)};
}

Written Form::written(const Box3& v) {
  return ConfigValue{ConfigValue::List{{v.lo.x}, {v.lo.y}, {v.lo.z}, {v.hi.x}, {v.hi.y}, {v.hi.z}}};
}

Binding<Config> input_format() {
  ChoiceRule rule{{"auto"}};
  for (const VolumeReader& reader : volume_readers()) rule.names.push_back(reader.name);
  rule.names.insert(rule.names.end(), {"empty", "mesh"});
  return member(&Config::input, &InputConfig::format, std::move(rule));
}

Binding<Config> unit() {
  return bound<Config>(
      ChoiceRule{{"m", "cm", "mm", "um", "nm", "angstrom"}},
      place(&Config::input, &InputConfig::unit),
      [](const ConfigValue& value, std::string& out) { Form::read(value, out); },
      [](const std::string& in) { return in.empty() ? std::nullopt : Form::written(in); });
}

Binding<Config> selected(std::string InputSelection::*text) {
  return bound<Config>(
      TextRule{}, [=](auto& config) -> auto& { return config.input.select.*text; },
      [](const ConfigValue& value, std::string& out) { Form::read(value, out); },
      [](const std::string& in) { return in.empty() ? std::nullopt : Form::written(in); });
}

Binding<Config> selected(std::optional<std::int64_t> InputSelection::*number) {
  constexpr std::int64_t most = 1'000'000;
  return bound<Config>(
      IntegerRule{0, most}, [=](auto& config) -> auto& { return config.input.select.*number; });
}

// The default is not written: it is no choice, and keys do not change with it.
ChoiceRule sample_types() {
  ChoiceRule rule;
  for (int i = 0; i <= static_cast<int>(SampleType::f64); ++i)
    rule.names.emplace_back(sample_type_name(static_cast<SampleType>(i)));
  return rule;
}

Binding<Config> raw_type() {
  return member(&Config::input, &InputConfig::type, sample_types());
}

namespace {

IsovalueChoice isovalue_of(const ConfigValue& v) {
  if (const auto* integer = v.integer()) return {Isovalue::of(*integer), {}};
  if (v.is_number()) return {v.number(), {}};
  if (const auto large = large_integer_of(v)) return {Isovalue::of(*large), {}};
  return {{}, *v.text() == "valley" ? IsovalueRule::valley : IsovalueRule::otsu};
}

ConfigValue value_of(const IsovalueChoice& choice) {
  if (!choice.value) return {std::string(isovalue_rule_name(choice.rule))};
  if (choice.value->rest == 0) return {choice.value->value};
  const __int128 integer = choice.value->integer();
  if (integer < 0) return {static_cast<std::int64_t>(integer)};
  return integer_value(static_cast<std::uint64_t>(integer));
}

}  // namespace

Binding<Config> isovalue() {
  return {NumberOrWordRule{{"otsu", "valley"}},
          [](Config& c, const ConfigValue& v) {
            SurfaceConfig& surface = c.surface;
            surface.isovalues.clear();
            IsovalueChoice one;
            if (v.list() == nullptr)
              one = isovalue_of(v);
            else
              for (const ConfigValue& item : *v.list())
                surface.isovalues.push_back(isovalue_of(item));
            surface.isovalue = one.value;
            surface.isovalue_rule = one.rule;
          },
          [](const Config& c) -> Written {
            // A mesh's config may not give one, so what stands for it inside is not told.
            if (c.input.is_mesh()) return std::nullopt;
            const SurfaceConfig& surface = c.surface;
            if (surface.isovalues.empty())
              return value_of({surface.isovalue, surface.isovalue_rule});
            ConfigValue::List list;
            for (const IsovalueChoice& choice : surface.isovalues) list.push_back(value_of(choice));
            return ConfigValue{list};
          }};
}

Binding<Config> surface_label() {
  return bound<Config>(
      LabelRule{}, place(&Config::surface, &SurfaceConfig::label),
      [](const ConfigValue& value, auto& out) { out = label_of(value).value(); },
      [](const auto& in) { return in ? Written(integer_value(*in)) : std::nullopt; });
}

Binding<Config> selected_labels() {
  using Select = LabelsConfig::Select;
  static const std::vector<std::string> words = {"all", "mapped"};
  return {LabelListRule{words},
          [](Config& c, const ConfigValue& v) {
            const auto* list = v.list();
            c.labels.select = list != nullptr      ? Select::listed
                              : *v.text() == "all" ? Select::all
                                                   : Select::mapped;
            c.labels.selected =
                list == nullptr ? std::vector<LabelRange>() : label_ranges_of(*list);
          },
          [](const Config& c) -> Written {
            if (c.labels.select == Select::listed)
              return ConfigValue{label_items(c.labels.selected)};
            return ConfigValue{words[static_cast<std::size_t>(c.labels.select)]};
          }};
}

Binding<Config> background() {
  return {LabelListRule{{}, true},
          [](Config& c, const ConfigValue& v) { c.labels.background = label_ranges_of(*v.list()); },
          [](const Config& c) -> Written { return ConfigValue{label_items(c.labels.background)}; }};
}

// In the order of the table: what is written does not depend on the order it was asked for in.
Binding<Config> formats() {
  std::vector<std::string> names;
  for (const MeshWriter& writer : mesh_writers()) names.emplace_back(writer.name);
  return bound<Config>(
      ChoiceListRule{names}, place(&Config::output, &OutputConfig::formats),
      [names](const ConfigValue& value, std::vector<std::string>& out) {
        Form::read(value, out);
        std::ranges::sort(out, {},
                          [&](const std::string& name) { return std::ranges::find(names, name); });
      },
      [](const std::vector<std::string>& in) { return Form::written(in); });
}

}  // namespace voxweld::binding
