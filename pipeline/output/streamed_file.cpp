#include "pipeline/output/streamed_file.h"

#include <fmt/format.h>

#include <optional>

#include "storage/meshes/mesh_file.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

using Corners = std::array<LatticePoint, 3>;

class DigestSink final : public MeshSink {
 public:
  DigestSink(const OutputLattice& lattice, const std::string& name)
      : lattice_(lattice), name_(name) {}

  void vertex(Vec3 place) override { vertices_.push_back(point(place)); }
  void triangle(const std::array<std::uint64_t, 3>& corners) override {
    add({vertices_[corners[0]], vertices_[corners[1]], vertices_[corners[2]]});
  }
  void facet(const std::array<Vec3, 3>& corners) override {
    add({point(corners[0]), point(corners[1]), point(corners[2])});
  }
  // As encode writes them: what is no label's number gives another digest.
  void labels(double inside, double outside) override {
    const auto material = [](double label) {
      return label >= 0 && label < 0x1p63 ? static_cast<Material>(label) : exterior;
    };
    const MaterialPair pair{material(inside), material(outside)};
    if (last_) sum_ += digest(*last_, &pair);
    last_.reset();
  }

  TriangleDigest take() {
    finish_last();
    return sum_;
  }

 private:
  LatticePoint point(Vec3 p) const {
    return lattice_point(
        {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}, lattice_,
        name_);
  }
  // Its labels may follow.
  void add(const Corners& corners) {
    finish_last();
    last_ = corners;
  }
  void finish_last() {
    if (last_) sum_ += digest(*last_, nullptr);
    last_.reset();
  }

  const OutputLattice& lattice_;
  const std::string& name_;
  std::vector<LatticePoint> vertices_;
  std::optional<Corners> last_;
  TriangleDigest sum_;
};

}  // namespace

TriangleDigest digest_of_file(const std::filesystem::path& path, const OutputLattice& lattice,
                              const std::function<void()>& between) {
  const std::string name = path.string();
  DigestSink sink(lattice, name);
  read_mesh_file(path, sink, between);
  return sink.take();
}

std::vector<Problem> compare_streamed(const std::filesystem::path& directory,
                                      const std::string& path, const OutputLattice& lattice,
                                      const TriangleDigest& of_tiles,
                                      const std::function<void()>& between) {
  try {
    const TriangleDigest found = digest_of_file(directory / path, lattice, between);
    if (found == of_tiles) return {};
    return {{path, fmt::format("its {} triangles are not the {} of the tiles put together",
                               found.count, of_tiles.count)}};
  } catch (const FormatError& error) {
    return {{path, error.what()}};
  }
}

}  // namespace voxweld
