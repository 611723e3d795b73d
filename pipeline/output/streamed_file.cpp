#include "pipeline/output/streamed_file.h"

#include <fmt/format.h>

#include <optional>

#include "stages/encode/vtp.h"
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

class VtpDigestSink final : public VtpSink {
 public:
  VtpDigestSink(const OutputLattice& lattice, const std::string& name,
                const std::function<void()>& between)
      : lattice_(lattice), name_(name), between_(between) {}

  void vertex(const std::array<float, 3>& place) override {
    vertices_.push_back(lattice_point(place, lattice_, name_));
  }
  void triangle(const std::array<std::uint32_t, 3>& corners, const MaterialPair* pair) override {
    if (between_ && sum_.count % (1 << 17) == 0) between_();
    sum_ += digest({vertices_[corners[0]], vertices_[corners[1]], vertices_[corners[2]]}, pair);
  }
  const TriangleDigest& sum() const { return sum_; }

 private:
  const OutputLattice& lattice_;
  const std::string& name_;
  const std::function<void()>& between_;
  std::vector<LatticePoint> vertices_;
  TriangleDigest sum_;
};

TriangleDigest digest_of_vtp(const std::string& name, const OutputLattice& lattice,
                             const std::function<void()>& between) {
  const ReadFile file(name);
  const VtpSource source{file.size(),
                         [&](std::uint64_t at, std::span<std::byte> to) { file.read(at, to); }};
  VtpDigestSink sink(lattice, name, between);
  read_vtp(source, name, sink);
  return sink.sum();
}

}  // namespace

TriangleDigest digest_of_file(const std::filesystem::path& path, const OutputLattice& lattice,
                              const std::function<void()>& between) {
  const std::string name = path.string();
  if (path.extension() == ".vtp") return digest_of_vtp(name, lattice, between);
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
