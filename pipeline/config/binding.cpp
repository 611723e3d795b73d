#include "pipeline/config/binding.h"

#include <cstdint>
#include <limits>

#include "pipeline/config/label_list.h"
#include "stages/encode/mesh_writers.h"
#include "storage/readers/open_volume.h"

namespace voxweld::binding {

Binding input_format() {
  ChoiceRule rule{{"auto"}};
  for (const VolumeReader& reader : volume_readers()) rule.names.push_back(reader.name);
  rule.names.insert(rule.names.end(), {"empty", "mesh"});
  return text(&Config::input, &InputConfig::format, std::move(rule));
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
            // A mesh's config may not give one, so what stands for it inside is not told.
            if (c.input.is_mesh()) return std::nullopt;
            if (!c.surface.isovalue) return ConfigValue{std::string("otsu")};
            return ConfigValue{*c.surface.isovalue};
          }};
}

Binding label() {
  return {IntegerRule{0, std::numeric_limits<std::int64_t>::max()},
          [](Config& c, const ConfigValue& v) {
            c.surface.label = static_cast<std::uint64_t>(*v.integer());
          },
          [](const Config& c) -> std::optional<ConfigValue> {
            if (!c.surface.label) return std::nullopt;
            return ConfigValue{static_cast<std::int64_t>(*c.surface.label)};
          }};
}

Binding selected_labels() {
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
          [](const Config& c) -> std::optional<ConfigValue> {
            if (c.labels.select == Select::listed)
              return ConfigValue{label_items(c.labels.selected)};
            return ConfigValue{words[static_cast<std::size_t>(c.labels.select)]};
          }};
}

Binding background() {
  return {LabelListRule{{}, true},
          [](Config& c, const ConfigValue& v) { c.labels.background = label_ranges_of(*v.list()); },
          [](const Config& c) -> std::optional<ConfigValue> {
            return ConfigValue{label_items(c.labels.background)};
          }};
}

// In the order of the table: what is written does not depend on the order it was asked for in.
Binding formats() {
  std::vector<std::string> names;
  for (const MeshWriter& writer : mesh_writers()) names.emplace_back(writer.name);
  return {ChoiceListRule{names},
          [names](Config& c, const ConfigValue& v) {
            c.output.formats.clear();
            for (const ConfigValue& item : *v.list()) c.output.formats.push_back(*item.text());
            std::ranges::sort(c.output.formats, {},
                              [&](const std::string& name) { return index_of(names, name); });
          },
          [](const Config& c) -> std::optional<ConfigValue> {
            ConfigValue::List list;
            for (const std::string& name : c.output.formats) list.push_back({name});
            return ConfigValue{std::move(list)};
          }};
}

}  // namespace voxweld::binding
