// Each label of a volume as a mesh of its own by VTK's FlyingEdges: of the label's box, 1 where it is
// and 0 elsewhere, at 0.5. Several labels at a time, one thread each.
// Usage: peer_labels VOLUME.nrrd FOLDER [THREADS]   writes FOLDER/<label>.ply
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSMPTools.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVersion.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "vtk_mesh.h"

namespace {

using namespace peers;

struct Box {
  std::array<int, 3> lo{}, hi{};  // half-open
};

std::map<std::uint32_t, Box> boxes_of(const Labels& labels) {
  std::map<std::uint32_t, Box> boxes;
  const auto [width, height, depth] = labels.size;
  const std::uint32_t* at = labels.samples.data();
  Box* box = nullptr;
  std::uint32_t last = 0;
  for (int z = 0; z < depth; ++z)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x, ++at) {
        if (*at == 0) continue;
        if (box == nullptr || *at != last) {
          last = *at;
          box = &boxes.try_emplace(last, Box{{x, y, z}, {x + 1, y + 1, z + 1}}).first->second;
        }
        const std::array<int, 3> place = {x, y, z};
        for (std::size_t a = 0; a < 3; ++a) {
          box->lo[a] = std::min(box->lo[a], place[a]);
          box->hi[a] = std::max(box->hi[a], place[a] + 1);
        }
      }
  return boxes;
}

// With a layer of none around it, which closes the mesh.
Mesh contour(const Labels& labels, std::uint32_t label, const Box& box) {
  vtkNew<vtkImageData> image;
  int extent[6];
  for (std::size_t a = 0; a < 3; ++a) {
    extent[2 * a] = box.lo[a] - 1;
    extent[2 * a + 1] = box.hi[a];
  }
  image->SetExtent(extent);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* to = static_cast<unsigned char*>(image->GetScalarPointer());
  std::fill(to, to + image->GetNumberOfPoints(), static_cast<unsigned char>(0));
  for (int z = box.lo[2]; z < box.hi[2]; ++z)
    for (int y = box.lo[1]; y < box.hi[1]; ++y) {
      const auto row = static_cast<std::size_t>(z) * static_cast<std::size_t>(labels.size[1]) +
                       static_cast<std::size_t>(y);
      const std::uint32_t* from =
          labels.samples.data() + row * static_cast<std::size_t>(labels.size[0]);
      auto* out = static_cast<unsigned char*>(image->GetScalarPointer(box.lo[0], y, z));
      for (int x = box.lo[0]; x < box.hi[0]; ++x) *out++ = from[x] == label ? 1 : 0;
    }
  vtkNew<vtkFlyingEdges3D> edges;
  edges->SetInputData(image);
  edges->SetValue(0, 0.5);
  edges->ComputeNormalsOff();
  edges->ComputeScalarsOff();
  edges->Update();
  return mesh_of(*edges->GetOutput());
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr, "usage: peer_labels VOLUME.nrrd FOLDER [THREADS]\n");
    return 2;
  }
  vtkSMPTools::Initialize(1);
  Stopwatch watch;
  Seconds seconds;
  const Labels labels = read_labels(argv[1]);
  seconds.reading = watch.lap();
  const std::string folder = argv[2];
  std::filesystem::create_directories(folder);
  const auto found = boxes_of(labels);
  const std::vector<std::pair<std::uint32_t, Box>> all(found.begin(), found.end());
  std::atomic<std::size_t> next{0}, triangles{0};
  std::mutex mutex;
  std::string failure;
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < all.size(); i = next++) {
        const Mesh mesh = contour(labels, all[i].first, all[i].second);
        triangles += mesh.triangles.size();
        write_ply(folder + "/" + std::to_string(all[i].first) + ".ply", mesh);
      }
    } catch (const std::exception& error) {
      const std::lock_guard<std::mutex> lock(mutex);
      failure = error.what();
    }
  };
  int threads = static_cast<int>(number_argument(argc, argv, 3, 0));
  if (threads == 0) threads = static_cast<int>(std::thread::hardware_concurrency());
  std::vector<std::thread> workers;
  for (int i = 0; i < threads; ++i) workers.emplace_back(work);
  for (std::thread& worker : workers) worker.join();
  if (!failure.empty()) throw std::runtime_error(failure);
  seconds.meshing = watch.lap();  // and writing, which goes on beside it
  print_figures(seconds, triangles, std::string("VTK ") + vtkVersion::GetVTKVersion());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "peer_labels: %s\n", error.what());
  return 1;
}
