#include "pipeline/config/edit_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace voxweld {
namespace {

using Shapes = std::vector<SolidShape>;

// The order of the names is that of the enumerators.
const std::vector<std::string>& op_names() {
  static const std::vector<std::string> names = {"add", "subtract", "intersect", "replace"};
  return names;
}

const std::vector<std::string>& shape_names() {
  static const std::vector<std::string> names = {"sphere", "box",   "cylinder", "cone",
                                                 "torus",  "plane", "mesh"};
  return names;
}

const std::vector<std::string>& closing_names() {
  static const std::vector<std::string> names = {"no", "winding"};
  return names;
}

struct Binding {
  Rule rule;
  std::function<void(EditConfig&, const ConfigValue&)> set;
  std::function<ConfigValue(const EditConfig&)> get;
};

template <class Enum>
Binding choice(Enum EditConfig::*member, const std::vector<std::string>& names) {
  return {
      ChoiceRule{names},
      [=](EditConfig& e, const ConfigValue& v) {
        const auto found = std::find(names.begin(), names.end(), *v.text());
        e.*member = static_cast<Enum>(found - names.begin());
      },
      [=](const EditConfig& e) { return ConfigValue{names[static_cast<std::size_t>(e.*member)]}; }};
}

Binding positive(double EditConfig::*member) {
  return {PositiveNumberRule{},
          [=](EditConfig& e, const ConfigValue& v) { e.*member = v.number(); },
          [=](const EditConfig& e) { return ConfigValue{e.*member}; }};
}

Binding triple(Vec3 EditConfig::*member, TripleRule::Of of = TripleRule::Of::any) {
  return {TripleRule{of},
          [=](EditConfig& e, const ConfigValue& v) {
            const auto& list = *v.list();
            e.*member = Vec3{list[0].number(), list[1].number(), list[2].number()};
          },
          [=](const EditConfig& e) {
            const Vec3 v = e.*member;
            return ConfigValue{ConfigValue::List{{v.x}, {v.y}, {v.z}}};
          }};
}

Binding material() {
  return {IntegerRule{0, std::numeric_limits<std::int64_t>::max()},
          [](EditConfig& e, const ConfigValue& v) {
            e.material = static_cast<std::uint64_t>(*v.integer());
          },
          [](const EditConfig& e) {
            return ConfigValue{static_cast<std::int64_t>(e.material.value_or(0))};
          }};
}

Binding path(std::filesystem::path EditConfig::*member) {
  return {PathRule{}, [=](EditConfig& e, const ConfigValue& v) { e.*member = *v.text(); },
          [=](const EditConfig& e) { return ConfigValue{(e.*member).string()}; }};
}

struct EditWords {
  const char* key;
  const char* description;
  const char* sample;
};

EditSetting row(EditWords words, Binding bound, Shapes shapes = {}) {
  EditSetting setting;
  setting.key = words.key;
  setting.rule = std::move(bound.rule);
  setting.description = words.description;
  setting.default_value = bound.get(EditConfig{});
  setting.shapes = std::move(shapes);
  setting.sample = words.sample;
  setting.set = std::move(bound.set);
  setting.get = std::move(bound.get);
  return setting;
}

EditSetting required(EditSetting setting) {
  setting.required = true;
  setting.default_note = "required";
  return setting;
}

EditSetting unset(const char* note, std::function<bool(const EditConfig&)> is_set,
                  EditSetting setting) {
  setting.default_value.reset();
  setting.default_note = note;
  setting.is_set = std::move(is_set);
  return setting;
}

EditSetting required_but_for(SolidShape shape, EditSetting setting) {
  const std::string value = to_toml(*setting.default_value);
  setting = required(std::move(setting));
  setting.default_note = fmt::format("required; of a {}, {}", shape_name(shape), value);
  setting.optional_for = {shape};
  return setting;
}

std::vector<EditSetting> make_edit_settings() {
  using enum SolidShape;
  using Of = TripleRule::Of;
  return {
      row({"op",
           "\"add\" makes the solid material, \"subtract\" takes it away, \"intersect\" takes away "
           "all but it. Between labels \"add\" gives all of it the label `material`, and "
           "\"replace\" only what is of some label already.",
           "\"subtract\""},
          choice(&EditConfig::op, op_names())),
      unset(
          "none; between labels add and replace need it",
          [](const EditConfig& e) { return e.material.has_value(); },
          row({"material",
               "Between labels (labels.mode): the label that add and replace give. Else not looked "
               "at.",
               "7"},
              material())),
      required(row({"shape", "Which solid it is.", ""}, choice(&EditConfig::shape, shape_names()))),
      required(row({"path",
                    "A triangle mesh in an .stl, .off, .obj or .ply file. It has to be closed; "
                    "which way its triangles wind does not matter, and what it encloses twice is "
                    "outside again.",
                    "\"part.stl\""},
                   path(&EditConfig::path), {mesh})),
      required_but_for(
          mesh, row({"center",
                     "The middle of the solid; of a plane, any point of it; of a mesh, where the "
                     "origin of its own coordinates comes to lie.",
                     "[10.0, 20.0, 30.0]"},
                    triple(&EditConfig::center))),
      required(
          row({"radius",
               "Of a sphere, a cylinder or a cone's base; of a torus, of the ring inside its tube.",
               "4.0"},
              positive(&EditConfig::radius), {sphere, cylinder, cone, torus})),
      required(row({"height", "Length from end to end.", "12.0"}, positive(&EditConfig::height),
                   {cylinder, cone})),
      required(row({"tube", "Radius of the tube itself, at most that of the ring.", "1.0"},
                   positive(&EditConfig::tube), {torus})),
      required(row({"size", "Lengths of the sides, before it is rotated.", "[4.0, 5.0, 6.0]"},
                   triple(&EditConfig::size, Of::positive), {box})),
      row({"axis",
           "A direction of any length: along the height, towards a cone's tip; across a torus's "
           "ring; of a plane, out of the solid, which lies behind it.",
           "[0.0, 0.0, 1.0]"},
          triple(&EditConfig::axis, Of::not_all_zero), {cylinder, cone, torus, plane}),
      row({"scale", "Lengths of the output for one of the mesh's own.", "25.4"},
          positive(&EditConfig::scale), {mesh}),
      row({"rotate",
           "Degrees to turn it about its center: about the x axis, then y, then z; x turns y "
           "towards z, y turns z towards x, z turns x towards y.",
           "[0.0, 0.0, 30.0]"},
          triple(&EditConfig::rotate), {box, mesh}),
      row({"close",
           "\"no\" refuses a mesh that is not closed; \"winding\" closes its holes, and makes one "
           "of "
           "what overlaps: inside is where its triangles wind around at least half.",
           "\"winding\""},
          choice(&EditConfig::close, closing_names()), {mesh}),
  };
}

std::vector<std::string> names_where(const std::function<bool(const EditSetting&)>& wanted) {
  std::vector<std::string> names;
  for (const EditSetting& setting : edit_settings())
    if (wanted(setting)) names.push_back(setting.key);
  return names;
}

}  // namespace

std::string_view shape_name(SolidShape shape) {
  return shape_names()[static_cast<std::size_t>(shape)];
}

bool EditSetting::taken_by(SolidShape shape) const {
  return shapes.empty() || std::find(shapes.begin(), shapes.end(), shape) != shapes.end();
}

bool EditSetting::required_by(SolidShape shape) const {
  return required && taken_by(shape) &&
         std::find(optional_for.begin(), optional_for.end(), shape) == optional_for.end();
}

std::string EditSetting::shapes_text() const {
  std::string text;
  for (const SolidShape shape : shapes) {
    if (!text.empty()) text += ", ";
    text += shape_name(shape);
  }
  return text.empty() ? "all" : text;
}

std::span<const EditSetting> edit_settings() {
  static const std::vector<EditSetting> all = make_edit_settings();
  return all;
}

const EditSetting* find_edit_setting(std::string_view key) {
  for (const EditSetting& setting : edit_settings())
    if (setting.key == key) return &setting;
  return nullptr;
}

std::vector<std::string> edit_key_names() {
  return names_where([](const EditSetting&) { return true; });
}

std::vector<std::string> edit_key_names(SolidShape shape) {
  return names_where([&](const EditSetting& setting) { return setting.taken_by(shape); });
}

std::string_view edit_description() {
  return "Solids that change the volume, one to each [[edit]], applied in the order of the file. "
         "Lengths are in the unit of the spacing; a place is spacing * sample index, before the "
         "volume's own origin and directions; with a mesh as input, it is in the mesh's own "
         "coordinates.";
}

std::vector<EditValue> values_of(const EditConfig& edit) {
  std::vector<EditValue> values;
  for (const EditSetting& setting : edit_settings())
    if (setting.taken_by(edit.shape) && (!setting.is_set || setting.is_set(edit)))
      values.push_back({&setting, setting.get(edit)});
  return values;
}

}  // namespace voxweld
