#include "storage/artifact/cube_mesh_artifact.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <tuple>

namespace voxweld {
namespace {

enum CubeMeshSection : std::uint64_t {
  cube_summary_section = 1,
  cube_pieces_section,
  cube_counted_section,
  cube_blocks_section,
  cube_changes_section,
  cube_intersecting_section
};

constexpr const char* contradicting = "its sections contradict each other";

static_assert(sizeof(CubePieceRecord) == 3 * 8 + 2 * 32 + 24 + 2 * 8);
static_assert(sizeof(CubeMeshSummary) == 8 + 32 + 8 + 2 * 16 + 2 * 24);
static_assert(sizeof(SurfaceSample) == 16);
static_assert(sizeof(IntersectionRecord) == 8 + 24 + 8);

std::uint64_t part_section(std::size_t piece, CubePart part) {
  return (std::uint64_t{piece} + 1) << 8 | static_cast<std::uint64_t>(part);
}

std::uint64_t holes_section(std::size_t piece) {
  return (std::uint64_t{piece} + 1) << 8 | 3;
}

struct PartHead {
  PartCounts counts;
  std::uint64_t normals = 0, aims = 0;
  std::uint64_t checked = 0, intersecting = 0;
};

// What of a part's bytes has not been looked at.
class PartBytes {
 public:
  explicit PartBytes(std::span<const std::byte> rest) : rest_(rest) {}

  // False where there is less. What is not wanted is passed by.
  template <class T>
  bool take(std::uint64_t count, std::vector<T>& out, bool wanted = true) {
    if (count > rest_.size() / sizeof(T)) return false;
    const std::size_t bytes = count * sizeof(T);
    if (wanted && bytes > 0) {
      out.resize(count);
      std::memcpy(out.data(), rest_.data(), bytes);
    }
    rest_ = rest_.subspan(bytes);
    return true;
  }
  bool empty() const { return rest_.empty(); }

 private:
  std::span<const std::byte> rest_;
};

bool numbers_fit(const RefineMesh& mesh) {
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      if (v >= mesh.positions.size()) return false;
  std::uint32_t last = 0;
  for (const SurfaceSample& sample : mesh.samples) {
    if (sample.triangle < last || sample.triangle >= mesh.triangles.size()) return false;
    last = sample.triangle;
  }
  for (std::size_t i = 0; i < mesh.intersecting.size(); ++i)
    if (mesh.intersecting[i] >= mesh.triangles.size() ||
        (i > 0 && mesh.intersecting[i] <= mesh.intersecting[i - 1]))
      return false;
  return true;
}

bool pieces_ascend(const std::vector<CubePieceRecord>& pieces) {
  const auto place = [](const CubePieceRecord& piece) {
    return std::tuple(piece.label, piece.code, piece.cube);
  };
  for (std::size_t i = 1; i < pieces.size(); ++i)
    if (place(pieces[i]) <= place(pieces[i - 1])) return false;
  return true;
}

}  // namespace

PartCounts counts_of(const RefineMesh& mesh) {
  return {mesh.positions.size(), mesh.triangles.size(), mesh.samples.size(), mesh.sides.size()};
}

PartCounts CubeMeshWriter::part(CubePart which, const RefineMesh& mesh) {
  const PartCounts counts = counts_of(mesh);
  if (counts.triangles == 0) return {};
  const PartHead head{counts, mesh.normals.empty() ? 0U : 1U, mesh.aims.empty() ? 0U : 1U,
                      mesh.checked ? 1U : 0U, mesh.intersecting.size()};
  file_.begin_section(part_section(pieces_.size(), which));
  file_.append(as_record(head));
  file_.append(as_section(mesh.positions));
  file_.append(as_section(mesh.ids));
  file_.append(as_section(mesh.normals));
  file_.append(as_section(mesh.aims));
  file_.append(as_section(mesh.triangles));
  file_.append(as_section(mesh.sides));
  file_.append(as_section(mesh.samples));
  file_.append(as_section(mesh.intersecting));
  file_.end_section();
  return counts;
}

void CubeMeshWriter::add(const PartCounts& counts, const LatticeBox& box, bool leaving) {
  const auto extend = [&](LatticeBox& all, bool first) {
    if (first) all = box;
    all.extend(box);
  };
  extend(summary_.box, summary_.all.triangles == 0);
  summary_.all += counts;
  if (!leaving) return;
  extend(summary_.leaving_box, summary_.leaving == 0);
  summary_.leaving += counts.triangles;
}

void CubeMeshWriter::piece(CubeKey key, Index3 cube, const RefineMesh& inside,
                           const RefineMesh& leaving, const PieceHoles& holes) {
  CubePieceRecord record{key.label, key.code, morton_encode(cube), {}, {}, {}, 0, 0};
  record.inside = part(CubePart::inside, inside);
  record.leaving = part(CubePart::leaving, leaving);
  if (record.inside.triangles > 0) add(record.inside, LatticeBox::around(inside.positions), false);
  if (record.leaving.triangles > 0) {
    record.leaving_box = LatticeBox::around(leaving.positions);
    add(record.leaving, record.leaving_box, true);
  }
  if (!holes.boxes.empty())
    file_.section(holes_section(pieces_.size()), std::as_bytes(holes.boxes));
  record.holes = holes.boxes.size();
  record.removed = holes.removed;
  if (pieces_.empty()) summary_.lowest = key;
  summary_.highest = key;
  pieces_.push_back(record);
}

Hash128 CubeMeshWriter::finish(const CubeMeshTables& tables) {
  summary_.pieces = pieces_.size();
  file_.section(cube_summary_section, as_record(summary_));
  file_.section(cube_pieces_section, as_section(pieces_));
  file_.section(cube_counted_section, tables.counted);
  file_.section(cube_blocks_section, std::as_bytes(tables.blocks));
  file_.section(cube_changes_section, std::as_bytes(tables.changes));
  file_.section(cube_intersecting_section, std::as_bytes(tables.intersecting));
  return file_.commit();
}

CubeMeshArtifact::CubeMeshArtifact(const std::filesystem::path& path)
    : OpenArtifact(path, cube_mesh_kind, cube_mesh_version),
      summary_(file_.read_record<CubeMeshSummary>(cube_summary_section, "has no valid summary")) {
  file_.read_array(cube_pieces_section, pieces_);
  if (pieces_.size() != summary_.pieces || !pieces_ascend(pieces_)) file_.damaged(contradicting);
}

Hash128 CubeMeshArtifact::hash_of(std::uint64_t section) const {
  const SectionRecord* found = file_.find(section);
  return found == nullptr ? Hash128{} : found->hash;
}

std::uint64_t CubeMeshArtifact::size_of(std::uint64_t section) const {
  const SectionRecord* found = file_.find(section);
  return found == nullptr ? 0 : found->size;
}

Hash128 CubeMeshArtifact::part_hash(std::size_t piece, CubePart part) const {
  return hash_of(part_section(piece, part));
}

Hash128 CubeMeshArtifact::holes_hash(std::size_t piece) const {
  return hash_of(holes_section(piece));
}

std::vector<LatticeBox> CubeMeshArtifact::holes(std::size_t piece) const {
  std::vector<LatticeBox> boxes;
  if (pieces_[piece].holes > 0) file_.read_array(holes_section(piece), boxes);
  if (boxes.size() != pieces_[piece].holes) file_.damaged(contradicting);
  return boxes;
}

RefineMesh CubeMeshArtifact::read(std::size_t piece, CubePart part,
                                  const PartFields& wanted) const {
  const CubePieceRecord& record = pieces_[piece];
  const PartCounts& counts = part == CubePart::inside ? record.inside : record.leaving;
  RefineMesh mesh;
  if (counts.triangles == 0) return mesh;
  const std::uint64_t section = part_section(piece, part), size = size_of(section);
  const auto memory = std::make_unique_for_overwrite<std::byte[]>(size);
  const std::span bytes(memory.get(), size);
  file_.read(section, bytes);
  PartBytes rest(bytes);
  std::vector<PartHead> head;
  const bool whole =
      rest.take(1, head) && head[0].counts.vertices == counts.vertices &&
      head[0].counts.triangles == counts.triangles && head[0].counts.samples == counts.samples &&
      head[0].counts.sided == counts.sided &&
      (counts.sided == 0 || counts.sided == counts.triangles) &&
      rest.take(counts.vertices, mesh.positions) && rest.take(counts.vertices, mesh.ids) &&
      rest.take(head[0].normals != 0 ? counts.vertices : 0, mesh.normals, wanted.normals) &&
      rest.take(head[0].aims != 0 ? counts.vertices : 0, mesh.aims, wanted.aims) &&
      rest.take(counts.triangles, mesh.triangles) && rest.take(counts.sided, mesh.sides) &&
      rest.take(counts.samples, mesh.samples, wanted.samples) &&
      rest.take(head[0].intersecting, mesh.intersecting) && rest.empty();
  if (!whole || !numbers_fit(mesh)) file_.damaged(contradicting);
  mesh.checked = head[0].checked != 0;
  return mesh;
}

std::vector<BlockRecord> CubeMeshArtifact::blocks() const {
  return file_.read_array<BlockRecord>(cube_blocks_section);
}

std::vector<LabelChange> CubeMeshArtifact::changes() const {
  return file_.read_array<LabelChange>(cube_changes_section);
}

std::vector<IntersectionRecord> CubeMeshArtifact::intersecting() const {
  return file_.read_array<IntersectionRecord>(cube_intersecting_section);
}

std::uint64_t CubeMeshArtifact::intersecting_count() const {
  return size_of(cube_intersecting_section) / sizeof(IntersectionRecord);
}

bool CubeMeshArtifact::counts_triangles() const {
  return size_of(cube_blocks_section) + size_of(cube_changes_section) > 0;
}

}  // namespace voxweld
