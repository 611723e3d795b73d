// The boxes that mend repairs.
#pragma once

#include <mutex>
#include <utility>
#include <vector>

#include "pipeline/refine/cube_meshes.h"
#include "pipeline/stage/refine_units.h"
#include "stages/refine/mend_boxes.h"

namespace voxweld {

// One box of one label, 0 of one surface.
struct MendBox {
  Material label = 0;
  LatticeBox box;
  CubeKey owner;  // of the unit in whose counts it is
};

// Where the boxes of a mesh lie, by what its artifacts say intersects. Thread-safe.
//
// Where there are few places all boxes are planned at once. Else each unit plans those that reach into its
// cubes. They end where cubes of the room's `walls` do. So it needs no places but those in such cubes.
class MendPlan {
 public:
  // places: artifacts that say what intersects, by the cubes of whatever pass. cubes: of the first one.
  // All outlive it.
  struct Inputs {
    CubeMeshes& places;
    const std::vector<RefineUnit>& units;
    const RefineFrame& frame;
    const MendRoom& room;
    const CubeLattice& cubes;
  };
  explicit MendPlan(const Inputs& inputs) : in_(inputs), walls_(inputs.frame, inputs.room.walls) {}

  // What it keeps; and what planning all boxes takes, which is over before any unit is run.
  std::uint64_t bytes();
  std::uint64_t planning_bytes() { return holds_all() ? places_count_ * bytes_of_place : 0; }

  // Of a unit the boxes that reach into its cubes, by label and ascending; what lies in no box, of those
  // places that begin in its cubes, whoever lists them; and how many places had to be held for that.
  struct Boxes {
    std::vector<MendBox> boxes;
    std::vector<IntersectionRecord> beside;
    std::uint64_t places = 0;
  };
  Boxes boxes(std::size_t unit);
  static constexpr std::uint64_t bytes_of_place = 360;

  // Whether there are so few places that all may be in memory at once. It depends on the mesh alone.
  bool holds_all();

 private:
  using Near = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

  void make();
  Near near_list(std::uint32_t list) const;
  template <class F>
  void each_record_near(std::size_t unit, F&& f);
  std::size_t unit_at(const CubeKey& cube) const;
  bool reaches(std::size_t unit, Material label, const LatticeBox& box) const;
  CubeKey begin_of(const IntersectionRecord& record) const {
    return {record.label, in_.cubes.code(in_.cubes.cube_of(record.box.lo))};
  }
  Boxes planned_boxes(std::size_t unit);
  Boxes boxes_within_walls(std::size_t unit);

  const Inputs in_;
  const CubeLattice walls_;
  std::once_flag counted_, made_, looked_;
  std::uint64_t places_count_ = 0;
  std::vector<MendBox> boxes_;
  std::vector<std::pair<CubeKey, std::uint32_t>> reached_;  // ascending: a cube's key and a box
  std::vector<IntersectionRecord> beside_;                  // by the cubes that they begin in
  // Ascending: a unit, and an artifact with places that it has to know.
  Near near_;
  std::mutex planning_;  // for one unit at a time, which bounds what it takes
};

}  // namespace voxweld
