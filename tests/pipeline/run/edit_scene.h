// A scene and the edits of its config.
#pragma once

#include <fmt/format.h>

#include <fstream>
#include <string>

#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {

// A scene whose config ends with these edits; size: of empty space in place of its volume.
class EditScene {
 public:
  explicit EditScene(const Scene& scene) : scene_(scene), base_(text_of_file(scene.config())) {}
  EditScene(const Scene& scene, Index3 size)
      : scene_(scene),
        base_(fmt::format(
            "[input]\nformat = \"empty\"\nsize = [{}, {}, {}]\n[simplify]\nrefine = \"off\"\n"
            "[run]\nthreads = 2\n",
            size.x, size.y, size.z)) {}

  void set(const std::string& edits) const { std::ofstream(scene_.config()) << base_ << edits; }

 private:
  const Scene& scene_;
  const std::string base_;
};

inline std::string ball(const std::string& op, Vec3 center, double radius) {
  return fmt::format(
      "[[edit]]\nop = \"{}\"\nshape = \"sphere\"\ncenter = [{}, {}, {}]\nradius = {}\n", op,
      center.x, center.y, center.z, radius);
}

}  // namespace voxweld::testing
