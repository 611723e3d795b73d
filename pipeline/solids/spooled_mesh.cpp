#include "pipeline/solids/spooled_mesh.h"

#include <fmt/format.h>

#include <cstring>
#include <optional>
#include <vector>

#include "storage/support/error.h"
#include "storage/support/record_sorter.h"

namespace voxweld {
namespace {

constexpr std::uint64_t piece_records = std::uint64_t{1} << 14;

// Records of one size, appended to a scratch file some at a time.
template <class T>
class Appender {
 public:
  explicit Appender(ScratchFile& file) : file_(file) { held_.reserve(piece_records); }
  void push(const T& record) {
    held_.push_back(record);
    if (held_.size() == piece_records) flush();
  }
  void flush() {
    file_.append(std::as_bytes(std::span(held_)));
    held_.clear();
  }

 private:
  ScratchFile& file_;
  std::vector<T> held_;
};

template <class T, class F>
void each_record(const ScratchFile& file, F&& f, const std::function<void()>& between) {
  std::vector<T> piece;
  for (std::uint64_t at = 0; at < file.size(); at += piece.size() * sizeof(T)) {
    if (between) between();
    piece.resize(std::min(piece_records, (file.size() - at) / sizeof(T)));
    file.read(at, std::as_writable_bytes(std::span(piece)));
    for (const T& record : piece) f(record);
  }
}

void extend(Bounds& bounds, Vec3 place, bool first) {
  for (int a = 0; a < 3; ++a) {
    bounds.lo[a] = first ? place[a] : std::min(bounds.lo[a], place[a]);
    bounds.hi[a] = first ? place[a] : std::max(bounds.hi[a], place[a]);
  }
}

}  // namespace

// Where the file has the numbers of corners, their places are found by sorting: the numbers by
// vertex, beside the vertices in their order; then the places by triangle.
class SpooledMesh::Reading final : public MeshSink {
 public:
  Reading(SpooledMesh& mesh, const MeshWork& work)
      : mesh_(mesh),
        work_(work),
        vertex_file_(work.folder),
        out_(mesh.file_),
        places_(vertex_file_),
        corners_(work.folder, work.memory / 4) {}

  void vertex(Vec3 place) override {
    place = place + Vec3{};
    extend(mesh_.vertex_bounds_, place, mesh_.vertices_++ == 0);
    places_.push(place);
  }
  void triangle(const std::array<std::uint64_t, 3>& corners) override {
    for (const std::uint64_t vertex : corners) corners_.push({vertex, corners_.size()}, {});
  }
  void facet(const std::array<Vec3, 3>& corners) override {
    Corners own;
    for (std::size_t i = 0; i < 3; ++i) {
      own[i] = corners[i] + Vec3{};
      extend(mesh_.vertex_bounds_, own[i], mesh_.vertices_++ == 0);
    }
    put(own);
  }

  std::uint64_t triangles() const { return std::max(mesh_.triangles_, corners_.size() / 3); }
  void finish() {
    places_.flush();
    if (corners_.size() > 0) join();
    out_.flush();
  }

 private:
  void put(const Corners& corners) {
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) return;
    for (const Vec3& corner : corners)
      extend(mesh_.bounds_, corner, mesh_.triangles_ == 0 && &corner == corners.data());
    out_.push(corners);
    ++mesh_.triangles_;
  }

  void join() {
    RecordSorter by_triangle(work_.folder, work_.memory / 4);
    SortKey key;
    std::vector<std::byte> record;
    std::uint64_t vertex = 0;
    bool any = corners_.next(key, record);
    each_record<Vec3>(
        vertex_file_,
        [&](const Vec3& place) {
          for (; any && key.major == vertex; any = corners_.next(key, record))
            by_triangle.push({key.minor, 0}, std::as_bytes(std::span(&place, 1)));
          ++vertex;
        },
        [&] { work_.step("sorting their corners", by_triangle.size() / 3); });
    corners_.clear();
    Corners corners;
    for (std::uint64_t corner = 0; by_triangle.next(key, record); ++corner) {
      std::memcpy(&corners[corner % 3], record.data(), sizeof(Vec3));
      if (corner % 3 != 2) continue;
      put(corners);
      if (corner % piece_records == 0) work_.step("finding their corners", corner / 3);
    }
  }

  SpooledMesh& mesh_;
  const MeshWork& work_;
  ScratchFile vertex_file_;
  Appender<Corners> out_;
  Appender<Vec3> places_;
  RecordSorter corners_;
};

SpooledMesh::SpooledMesh(const std::filesystem::path& path, const MeshWork& work)
    : file_(work.folder) {
  Reading reading(*this, work);
  facts_ = read_mesh_file(path, reading, [&] { work.step("reading", reading.triangles()); });
  reading.finish();
  if (triangles_ == 0) throw FormatError(fmt::format("{}: no triangles", path.string()));
}

void SpooledMesh::each(const std::function<void(const Corners&)>& f,
                       const std::function<void()>& between) const {
  each_record<Corners>(file_, f, between);
}

}  // namespace voxweld
