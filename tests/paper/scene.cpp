#include "tests/paper/scene.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "pipeline/config/edit_settings.h"
#include "storage/support/file_io.h"

namespace voxweld::paper {
namespace {

std::array<Vec3, 3> axes_turned(Vec3 degrees) {
  std::array<Vec3, 3> axes = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  for (int about = 0; about < 3; ++about) {
    const double a = degrees[about] * std::numbers::pi / 180;
    const int from = (about + 1) % 3, to = (about + 2) % 3;
    for (Vec3& axis : axes) {
      const double u = axis[from], v = axis[to];
      axis[from] = std::cos(a) * u - std::sin(a) * v;
      axis[to] = std::sin(a) * u + std::cos(a) * v;
    }
  }
  return axes;
}

}  // namespace

Scene::Scene(std::filesystem::path folder, const Place& place)
    : folder_(std::move(folder)),
      cells_(place.cells),
      scale_(static_cast<double>(place.cells) / place.model_cells),
      degrees_(place.degrees),
      axes_(axes_turned(place.degrees)) {
  // Off the middle by parts of a cell, so that no face of a model that is not turned lies on
  // samples.
  const double middle = static_cast<double>(cells_ - 2) / 2;
  centre_ = Vec3{middle + 0.3719, middle + 0.2287, middle - 0.1393};
}

Vec3 Scene::turned(Vec3 v) const {
  return axes_[0] * v.x + axes_[1] * v.y + axes_[2] * v.z;
}
Vec3 Scene::place(Vec3 p) const {
  return centre_ + turned(p) * scale_;
}
Vec3 Scene::unplace(Vec3 p) const {
  const Vec3 d = (p - centre_) * (1 / scale_);
  return {dot(d, axes_[0]), dot(d, axes_[1]), dot(d, axes_[2])};
}

EditConfig Scene::solid(EditOp op, SolidShape shape) const {
  EditConfig edit;
  edit.op = op;
  edit.shape = shape;
  if (op == EditOp::add) edit.material = material_;
  return edit;
}

void Scene::box(EditOp op, Vec3 centre, Vec3 half) {
  EditConfig edit = solid(op, SolidShape::box);
  edit.center = place(centre);
  edit.size = half * (2 * scale_);
  edit.rotate = degrees_;
  edits_.push_back(edit);
}

void Scene::cylinder(EditOp op, Vec3 centre, Vec3 axis, double radius, double height) {
  EditConfig edit = solid(op, SolidShape::cylinder);
  edit.center = place(centre);
  edit.axis = turned(axis);
  edit.radius = radius * scale_;
  edit.height = height * scale_;
  edits_.push_back(edit);
}

void Scene::mesh(EditOp op, const std::filesystem::path& file, Vec3 origin) {
  EditConfig edit = solid(op, SolidShape::mesh);
  edit.path = file;
  edit.center = place(origin);
  edit.scale = scale_;
  edit.rotate = degrees_;
  edits_.push_back(edit);
}

void Scene::write(const std::string& name, const std::string& title) const {
  std::string text = fmt::format(
      "# {0}\n[input]\nformat = \"empty\"\nsize = [{1}, {1}, {1}]\n{2}\n[simplify]\ntolerance = "
      "0.01\n"
      "metric = \"sum\"\n\n[output]\nformats = [\"drc\"]\n\n[run]\nthreads = 1\n",
      title, samples(), material_ ? "\n[labels]\nmode = \"shared\"\n" : "");
  for (const EditConfig& edit : edits_) {
    text += "\n[[edit]]\n";
    for (const EditValue& value : values_of(edit))
      text += value.setting->key + " = " + to_toml(value.value) + "\n";
  }
  write_whole_file(folder_ / (name + ".toml"), as_bytes(text), Durability::rename_only);
}

}  // namespace voxweld::paper
