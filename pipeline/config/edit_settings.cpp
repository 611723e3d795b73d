#include "pipeline/config/edit_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "pipeline/config/binding.h"
#include "pipeline/config/label_list.h"

namespace voxweld {
namespace {

using Shapes = std::vector<SolidShape>;

const std::vector<std::string>& shape_names() {
  static const std::vector<std::string> names = {"sphere", "box",   "cylinder", "cone",
                                                 "torus",  "plane", "mesh"};
  return names;
}

using Binding = binding::Binding<EditConfig>;

template <class T>
auto place(T EditConfig::*member) {
  return [=](auto& edit) -> auto& {
    return edit.*member;
  };
}

template <class T>
Binding member(T EditConfig::*member, Rule rule) {
  return binding::bound<EditConfig>(std::move(rule), place(member));
}

template <class Enum>
Binding choice(Enum EditConfig::*member, const std::vector<std::string>& names) {
  return binding::bound_choice<EditConfig>(names, place(member));
}

// 0 where it is not set.
Binding material() {
  return binding::bound<EditConfig>(
      LabelRule{}, place(&EditConfig::material),
      [](const ConfigValue& value, auto& out) { out = label_of(value).value(); },
      [](const auto& in) { return integer_value(in.value_or(0)); });
}

struct EditWords {
  const char* key;
  const char* description;
  const char* sample;
};

EditSetting row(EditWords words, const Binding& bound, Shapes shapes = {}) {
  return {{words.key, bound.rule, words.description, false, {}, bound.get(EditConfig{})},
          std::move(shapes),
          {},
          words.sample,
          bound.set,
          [get = bound.get](const EditConfig& edit) { return get(edit).value(); },
          {}};
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
          choice(&EditConfig::op, {"add", "subtract", "intersect", "replace"})),
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
                   member(&EditConfig::path, PathRule{}), {mesh})),
      required_but_for(
          mesh, row({"center",
                     "The middle of the solid; of a plane, any point of it; of a mesh, where the "
                     "origin of its own coordinates comes to lie.",
                     "[10.0, 20.0, 30.0]"},
                    member(&EditConfig::center, TripleRule{}))),
      required(
          row({"radius",
               "Of a sphere, a cylinder or a cone's base; of a torus, of the ring inside its tube.",
               "4.0"},
              member(&EditConfig::radius, PositiveNumberRule{}), {sphere, cylinder, cone, torus})),
      required(row({"height", "Length from end to end.", "12.0"},
                   member(&EditConfig::height, PositiveNumberRule{}), {cylinder, cone})),
      required(row({"tube", "Radius of the tube itself, at most that of the ring.", "1.0"},
                   member(&EditConfig::tube, PositiveNumberRule{}), {torus})),
      required(row({"size", "Lengths of the sides, before it is rotated.", "[4.0, 5.0, 6.0]"},
                   member(&EditConfig::size, TripleRule{Of::positive}), {box})),
      row({"axis",
           "A direction of any length: along the height, towards a cone's tip; across a torus's "
           "ring; of a plane, out of the solid, which lies behind it.",
           "[0.0, 0.0, 1.0]"},
          member(&EditConfig::axis, TripleRule{Of::not_all_zero}), {cylinder, cone, torus, plane}),
      row({"scale", "Lengths of the output for one of the mesh's own.", "25.4"},
          member(&EditConfig::scale, PositiveNumberRule{}), {mesh}),
      row({"rotate",
           "Degrees to turn it about its center: about the x axis, then y, then z; x turns y "
           "towards z, y turns z towards x, z turns x towards y.",
           "[0.0, 0.0, 30.0]"},
          member(&EditConfig::rotate, TripleRule{}), {box, mesh}),
      row({"close",
           "\"no\" refuses a mesh that is not closed; \"winding\" closes its holes, and makes one "
           "of "
           "what overlaps: inside is where its triangles wind around at least half.",
           "\"winding\""},
          choice(&EditConfig::close, {"no", "winding"}), {mesh}),
  };
}

}  // namespace

std::string_view shape_name(SolidShape shape) {
  return shape_names()[static_cast<std::size_t>(shape)];
}

bool EditSetting::taken_by(SolidShape shape) const {
  return shapes.empty() || std::ranges::find(shapes, shape) != shapes.end();
}

bool EditSetting::required_by(SolidShape shape) const {
  return required && taken_by(shape) &&
         std::ranges::find(optional_for, shape) == optional_for.end();
}

std::string EditSetting::shapes_text() const {
  std::vector<std::string_view> names;
  for (const SolidShape shape : shapes) names.push_back(shape_name(shape));
  return names.empty() ? "all" : fmt::format("{}", fmt::join(names, ", "));
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

std::vector<std::string> edit_key_names(std::optional<SolidShape> shape) {
  std::vector<std::string> names;
  for (const EditSetting& setting : edit_settings())
    if (!shape || setting.taken_by(*shape)) names.push_back(setting.key);
  return names;
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
