// A mesh by VTK's FlyingEdges, which cuts every cell by its own, with the threads that VTK takes;
// then, with an error given, simplified by meshoptimizer, which has one thread.
// Usage: peer_flying_edges VOLUME.nrrd MESH.ply [ERROR [THREADS]]   ERROR: in samples; 0: none
#include <meshoptimizer.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSMPTools.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedShortArray.h>
#include <vtkVersion.h>

#include <cstdio>
#include <string>

#include "vtk_mesh.h"

namespace {

using namespace peers;

template <class Array, class Sample>
void set_samples(vtkImageData& image, Sample* samples, std::size_t count) {
  vtkNew<Array> array;
  array->SetArray(samples, static_cast<vtkIdType>(count), 1);  // stays the volume's
  image.GetPointData()->SetScalars(array);
}

void set(vtkImageData& image, std::uint8_t* samples, std::size_t count) {
  set_samples<vtkUnsignedCharArray>(image, samples, count);
}
void set(vtkImageData& image, std::uint16_t* samples, std::size_t count) {
  set_samples<vtkUnsignedShortArray>(image, samples, count);
}
void set(vtkImageData& image, float* samples, std::size_t count) {
  set_samples<vtkFloatArray>(image, samples, count);
}

Mesh contour(Volume& volume) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(volume.size.data());
  with_samples(volume, [&](auto* samples) {
    set(*image, samples, volume.samples.size() / sizeof(*samples));
  });
  vtkNew<vtkFlyingEdges3D> edges;
  edges->SetInputData(image);
  edges->SetValue(0, volume.isovalue);
  edges->ComputeNormalsOff();
  edges->ComputeScalarsOff();
  edges->Update();
  return mesh_of(*edges->GetOutput());
}

// Without the vertices that are no longer used.
void simplify(Mesh& mesh, double error) {
  constexpr std::size_t stride = sizeof(mesh.vertices[0]);
  std::uint32_t* corners = mesh.triangles[0].data();
  const std::size_t count = 3 * mesh.triangles.size();
  float* vertices = mesh.vertices[0].data();
  const float scale = meshopt_simplifyScale(vertices, mesh.vertices.size(), stride);
  const std::size_t left = meshopt_simplify(corners, corners, count, vertices, mesh.vertices.size(),
                                            stride, 0, static_cast<float>(error) / scale);
  const std::size_t used =
      meshopt_optimizeVertexFetch(vertices, corners, left, vertices, mesh.vertices.size(), stride);
  mesh.triangles.resize(left / 3);
  mesh.vertices.resize(used);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr,
                 "usage: peer_flying_edges VOLUME.nrrd MESH.ply [ERROR [THREADS]]\n"
                 "ERROR: to which meshoptimizer simplifies, in samples; 0: not at all\n");
    return 2;
  }
  const double error = number_argument(argc, argv, 3, 0);
  vtkSMPTools::Initialize(static_cast<int>(number_argument(argc, argv, 4, 0)));
  Stopwatch watch;
  Seconds seconds;
  Volume volume = read_volume(argv[1]);
  seconds.reading = watch.lap();
  Mesh mesh = contour(volume);
  volume.samples = {};
  if (error > 0 && !mesh.triangles.empty()) simplify(mesh, error);
  seconds.meshing = watch.lap();
  write_ply(argv[2], mesh);
  seconds.writing = watch.lap();
  const int version = MESHOPTIMIZER_VERSION;
  std::string library = std::string("VTK ") + vtkVersion::GetVTKVersion();
  if (error > 0)
    library += ", meshoptimizer " + std::to_string(version / 1000) + "." +
               std::to_string(version % 1000 / 10);
  print_figures(seconds, mesh.triangles.size(), library);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "peer_flying_edges: %s\n", error.what());
  return 1;
}
