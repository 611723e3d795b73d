// Which nodes of a brick's octree may collapse, as far as the corners of the cells below say.
#pragma once

namespace voxweld {

class CollapseRule {
 public:
  virtual ~CollapseRule() = default;
  // The node of `side` cells at (x, y, z) relative to the brick; its children are leaves or
  // homogeneous.
  virtual bool allows(int x, int y, int z, int side) const = 0;
};

}  // namespace voxweld
