// Pictures of the mesh of an output directory from three sides.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "pipeline/executor/interrupt.h"
#include "pipeline/output/render.h"

namespace voxweld {

struct ViewOptions {
  int width = 440, height = 360, supersample = 2;
  bool threads = true;  // a thread for each picture, and some that decode
  // Bytes: what takes neither a quarter of that nor 128 MiB is kept, and so read once.
  std::uint64_t memory = std::uint64_t{256} << 20;
  std::uint64_t triangles = 0;  // there are, as the manifest says
  bool closed = false;          // the mesh hides its own back sides
  const InterruptFlag* interrupt = nullptr;
};

inline constexpr std::array<double, 3> view_azimuths = {30, 150, 270};
inline constexpr double view_elevation = 25;

struct MeshViews {
  MeshBounds bounds;
  std::array<Image, 3> pictures;
};

// Some tiles at a time, so that memory does not grow with the mesh. Throws what for_each_mesh throws;
// Interrupted.
MeshViews draw_views(const std::filesystem::path& directory, const ViewOptions& options);

}  // namespace voxweld
