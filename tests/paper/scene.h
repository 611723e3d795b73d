// Models of solids: told in their own frame, put in their place in a grid, and written as configs
// of empty space with [[edit]] tables.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/config/config.h"
#include "tests/paper/extrusion.h"

namespace voxweld::paper {

struct Place {
  std::int64_t cells = 256;  // of the octree's root, a side; samples are one fewer
  double model_cells = 256;  // that many the model's lengths are meant for
  Vec3 degrees{};            // turned about x, then y, then z
};

class Scene {
 public:
  Scene(std::filesystem::path folder, const Place& place);

  // All solids added from here on are of this material, and those in place are overwritten.
  void of_material(std::uint64_t material) { material_ = material; }

  void box(EditOp op, Vec3 centre, Vec3 half);
  void cylinder(EditOp op, Vec3 centre, Vec3 axis, double radius, double height);
  // file: in the scene's folder, or absolute; its own origin comes to lie at `origin`.
  void mesh(EditOp op, const std::filesystem::path& file, Vec3 origin);

  double scale() const { return scale_; }  // cells for one unit of the model
  // From the model's frame to the grid's, and the other way.
  Vec3 place(Vec3 p) const;
  Vec3 unplace(Vec3 p) const;

  // <folder>/<name>.toml with the paper's settings: error 0.01 in the sum of squares.
  void write(const std::string& name, const std::string& title) const;
  const std::filesystem::path& folder() const { return folder_; }
  std::int64_t samples() const { return cells_ - 1; }

 private:
  Vec3 turned(Vec3 v) const;

  std::filesystem::path folder_;
  std::int64_t cells_;
  double scale_;
  Vec3 degrees_, centre_;
  std::array<Vec3, 3> axes_;  // of the model, in the grid's frame
  EditConfig solid(EditOp op, SolidShape shape) const;

  std::optional<std::uint64_t> material_;
  std::vector<EditConfig> edits_;
};

}  // namespace voxweld::paper
