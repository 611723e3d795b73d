// Labels whose interfaces are known exactly: three that meet in a line and four that meet in a
// point.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/phantom/fields.h"
#include "pipeline/phantom/rotation.h"

namespace voxweld {

// Two balls of radius R = 0.2 N at c -+ (N / 4, 0, 0), each a cone complex: with directions w_k,
// and q the position from the ball's centre, the label of q is that of the largest w_k . q (the
// lowest on a tie), and 0 where |q| > R.
//   wedges (the lower x), labels 1 .. 3: w_k = M^T (cos a, sin a, 0), a = 2 pi k / 3, with M =
//     Rz(0.37) Ry(0.61) Rx(0.23). Three half disks meet in the diameter along M^T (0, 0, 1).
//   foam, labels 4 .. 7: w_k = M^T u_k, u = (1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1), M =
//     Rz(0.5) Ry(0.4) Rx(0.9). Six sectors of a disk, in pairs along the four radii -w_k, all of
//     which meet in the centre, as films and borders of a foam do.
// So each interface of two labels is a flat sector of a disk, and that of a label with 0 a piece of
// a sphere between arcs, all of them convex: the nearest point is found in closed form. Three
// labels meet in radii and arcs, four in the ends of the diameter, in the centre of the foam and in
// the ends of its radii. Each wedge has 1/3 of its ball's volume, each cell of the foam 1/4.
class JunctionsField : public PhantomField {
 public:
  explicit JunctionsField(std::int64_t size);

  void fill(const Box3& box, double limit, double* out) const override;
  Index3 block() const override { return {64, 4, 4}; }

  static constexpr std::uint64_t labels = 7;
  std::uint64_t label_at(Vec3 p) const;
  double radius() const { return radius_; }
  double volume(std::uint64_t label) const;  // 1 .. 7, in voxels
  // The distance from p to the interface of the two, in voxels; infinite where they have none.
  double interface_distance(Vec3 p, std::uint64_t a, std::uint64_t b) const;
  // To the nearest interface of any two.
  double surface_distance(Vec3 p) const;
  // To the nearest place where at least three labels meet, 0 included; at least four.
  double curve_distance(Vec3 p) const;
  double corner_distance(Vec3 p) const;

 private:
  // Between labels a and b of a ball: what of the plane of `middle` and `side` lies within `angle`
  // of the middle, to either side, and within the ball.
  struct Sector {
    std::uint64_t a = 0, b = 0;
    Vec3 middle, side;
    double angle = 0;
  };
  struct Ball {
    Vec3 centre;
    std::vector<Vec3> directions;
    std::uint64_t first_label = 0;
    std::vector<Sector> sectors;
    std::vector<Vec3> borders;    // unit; along these radii three labels or more meet
    bool meet_in_centre = false;  // four of them
  };
  // Where q is, seen from the plane of a sector.
  struct InPlane {
    double along = 0, across = 0, above = 0;  // across: not negative, by symmetry
  };

  static InPlane in_plane(const Sector& sector, Vec3 q);
  static Ball wedges(Vec3 centre);
  static Ball foam(Vec3 centre);
  const Ball& ball_of(Vec3 p) const { return balls_[p.x < centre_ ? 0 : 1]; }
  const Ball& ball_with(std::uint64_t label) const { return balls_[label < 4 ? 0 : 1]; }
  std::uint64_t cone_of(const Ball& ball, Vec3 q) const;
  double disk_distance(const Sector& sector, Vec3 q) const;
  double arc_distance(const Sector& sector, Vec3 q) const;
  double sphere_distance(const Ball& ball, std::uint64_t label, Vec3 q) const;

  double centre_, radius_;
  std::array<Ball, 2> balls_;
};

}  // namespace voxweld
