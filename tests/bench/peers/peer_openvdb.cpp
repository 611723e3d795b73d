// A mesh by OpenVDB's volumeToMesh, with all the threads that TBB takes.
// Usage: peer_openvdb VOLUME.nrrd MESH.ply ADAPTIVITY [THREADS]
// The grid is made as its users make one of a scan: copyFromDense, every sample kept, no narrow
// band: of a scan nobody knows the distances to its surface.
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>

#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>

#include "peer_files.h"

namespace {

using namespace peers;

// Around the samples there is no material: the background is far above the isovalue.
openvdb::FloatGrid::Ptr grid_of(Volume& volume) {
  return with_samples(volume, [&](auto* samples) {
    using Sample = std::remove_pointer_t<decltype(samples)>;
    float most = std::numeric_limits<float>::lowest();
    const std::size_t count = volume.samples.size() / sizeof(Sample);
    for (std::size_t i = 0; i < count; ++i) most = std::max(most, static_cast<float>(samples[i]));
    auto grid = openvdb::FloatGrid::create(most);
    const openvdb::CoordBBox box({0, 0, 0},
                                 {volume.size[0] - 1, volume.size[1] - 1, volume.size[2] - 1});
    const openvdb::tools::Dense<Sample, openvdb::tools::LayoutXYZ> dense(box, samples);
    openvdb::tools::copyFromDense(dense, *grid, 0.0F);
    return grid;
  });
}

struct Polygons {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
};

Mesh mesh_of(const Polygons& polygons) {
  Mesh mesh;
  mesh.vertices.reserve(polygons.points.size());
  for (const auto& p : polygons.points) mesh.vertices.push_back({p.x(), p.y(), p.z()});
  mesh.triangles.reserve(polygons.triangles.size() + 2 * polygons.quads.size());
  for (const auto& t : polygons.triangles) mesh.triangles.push_back({t[0], t[1], t[2]});
  for (const auto& q : polygons.quads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 4) {
    std::fprintf(stderr, "usage: peer_openvdb VOLUME.nrrd MESH.ply ADAPTIVITY [THREADS]\n");
    return 2;
  }
  const int threads = static_cast<int>(number_argument(argc, argv, 4, 0));
  std::optional<tbb::global_control> limit;
  if (threads > 0)
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  openvdb::initialize();
  Stopwatch watch;
  Seconds seconds;
  Volume volume = read_volume(argv[1]);
  seconds.reading = watch.lap();
  const auto grid = grid_of(volume);
  volume.samples = {};
  Polygons polygons;
  openvdb::tools::volumeToMesh(*grid, polygons.points, polygons.triangles, polygons.quads,
                               volume.isovalue, number_argument(argc, argv, 3, 0));
  const Mesh mesh = mesh_of(polygons);
  seconds.meshing = watch.lap();
  write_ply(argv[2], mesh);
  seconds.writing = watch.lap();
  print_figures(seconds, mesh.triangles.size(),
                std::string("OpenVDB ") + openvdb::getLibraryVersionString());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "peer_openvdb: %s\n", error.what());
  return 1;
}
