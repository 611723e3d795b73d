// How far meshes lie from the solids they stand for.
#pragma once

#include <span>

#include "storage/types/solid.h"
#include "storage/types/triangle_mesh.h"

namespace voxweld::paper {

// Spheres, tori and boxes only: distance of p to the surface, and the solid's volume, exactly.
double distance_to_surface(const Solid& solid, Vec3 p);
double volume_of_solid(const Solid& solid);

// Degrees between `unit` and the surface's outward normal near p. Within `reach` of an edge the
// normals of both faces are right, and the nearer one counts.
double degrees_off(const Solid& solid, Vec3 p, Vec3 unit, double reach);

struct SurfaceErrors {
  std::size_t triangles = 0;
  double mean = 0, rms = 0, max = 0;  // distance, by area
  // Of the triangles' own normals, by area; worst_degrees: 99 of 100 are off by at most this.
  double mean_degrees = 0, worst_degrees = 0, max_degrees = 0;
  double volume = 0;  // of the mesh's, relative to the solid's
};
// From ten points of each triangle, evenly spread in it; an edge reaches 0.75.
SurfaceErrors surface_errors(const Solid& solid, const TriangleMesh& mesh);

}  // namespace voxweld::paper
