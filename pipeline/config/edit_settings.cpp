#include "pipeline/config/edit_settings.h"

#include <utility>

#include "pipeline/config/item_rows.h"
#include "pipeline/config/label_list.h"

namespace voxweld {
namespace {

using item_rows::choice;
using item_rows::member;
using item_rows::open;
using item_rows::required;

binding::Binding<EditConfig> material() {
  return binding::bound<EditConfig>(
      LabelRule{}, item_rows::place(&EditConfig::material),
      [](const ConfigValue& value, auto& out) { out = label_of(value).value(); },
      [](const auto& in) { return in ? binding::Written(integer_value(*in)) : std::nullopt; });
}

EditSetting row(item_rows::ItemWords words, const binding::Binding<EditConfig>& bound,
                std::vector<SolidShape> shapes = {}) {
  return item_rows::row(words, bound, std::move(shapes));
}

EditSetting required_but_for_mesh(EditSetting setting) {
  const std::string value = to_toml(*setting.default_value);
  setting = required(std::move(setting));
  setting.default_note = "required; of a mesh, " + value;
  setting.optional_for = {SolidShape::mesh};
  return setting;
}

std::vector<EditSetting> make_edit_settings(const std::vector<std::string>& shapes) {
  using enum SolidShape;
  using Of = TripleRule::Of;
  return {
      row({"op",
           "\"add\" makes the solid material, \"subtract\" takes it away, \"intersect\" takes away "
           "all but it. Between labels \"add\" gives all of it the label `material`, and "
           "\"replace\" only what is of some label already.",
           "\"subtract\""},
          choice(&EditConfig::op, {"add", "subtract", "intersect", "replace"})),
      open(
          "none; between labels add and replace need it",
          row({"material",
               "Between labels (labels.mode): the label that add and replace give. Else not looked "
               "at.",
               "7"},
              material())),
      required(row({"shape", "Which solid it is.", ""}, choice(&EditConfig::shape, shapes))),
      required(row({"path",
                    "A triangle mesh in an .stl, .off, .obj or .ply file. It has to be closed; "
                    "which way its triangles wind does not matter, and what it encloses twice is "
                    "outside again.",
                    "\"part.stl\""},
                   member(&EditConfig::path, PathRule{}), {mesh})),
      required_but_for_mesh(
          row({"center",
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

EditTable make_edit_table() {
  const std::vector<std::string> shapes = {"sphere", "box",   "cylinder", "cone",
                                           "torus",  "plane", "mesh"};
  return {.name = std::string(edit_table),
          .one = "an edit",
          .kind_key = "shape",
          .noun = "",
          .description =
              "Solids that change the volume, one to each [[edit]], applied in the order of the "
              "file. Lengths are in the unit of the spacing; a place is spacing * sample index, "
              "before the volume's own origin and directions; with a mesh as input, it is in the "
              "mesh's own coordinates.",
          .stage = Stage::build,
          .reruns = "build, where it reaches",
          .kind = &EditConfig::shape,
          .kind_names = shapes,
          .settings = make_edit_settings(shapes)};
}

}  // namespace

const EditTable& edit_items() {
  static const EditTable table = make_edit_table();
  return table;
}

std::string_view shape_name(SolidShape shape) {
  return edit_items().kind_name(shape);
}

std::span<const EditSetting> edit_settings() {
  return edit_items().settings;
}

const EditSetting* find_edit_setting(std::string_view key) {
  return edit_items().find(key);
}

std::vector<std::string> edit_key_names(std::optional<SolidShape> shape) {
  return edit_items().key_names(shape);
}

std::vector<EditValue> values_of(const EditConfig& edit) {
  return edit_items().values_of(edit);
}

}  // namespace voxweld
