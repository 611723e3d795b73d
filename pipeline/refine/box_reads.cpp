#include "pipeline/refine/box_reads.h"

#include <algorithm>
#include <numeric>

#include "pipeline/executor/probe.h"
#include "stages/refine/box_refiner.h"
#include "stages/refine/mesh_part.h"
#include "stages/refine/retile.h"

namespace voxweld {
namespace {

// The part of `whole` that lies no further from `box` than a quarter of the side of `whole`.
double part_near(const LatticeBox& whole, const LatticeBox& box) {
  double part = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const double side = static_cast<double>(whole.hi[a]) - whole.lo[a] + 1;
    const double lo = std::max<double>(whole.lo[a], box.lo[a] - side / 4);
    const double hi = std::min<double>(whole.hi[a], box.hi[a] + side / 4);
    part *= std::clamp((hi - lo + 1) / side, 0.0, 1.0);
  }
  return part;
}

LatticeBox box_of_run(const RefineMesh& mesh, std::size_t first, std::size_t end) {
  LatticeBox around = mesh.box(first);
  for (std::size_t t = first + 1; t < end; ++t) around.extend(mesh.box(t));
  return around;
}

}  // namespace

BoxReads::BoxReads(CubeMeshes& meshes, const CubeLattice& cubes, const MendBox& box)
    : meshes_(meshes), box_(box) {
  const CubeKey begin{box.label, 0}, end{box.label, CubeRange{}.end};
  const Box3 near{cubes.cube_of(box.box.lo), cubes.cube_of(box.box.hi) + splat(1)};
  const auto& entries = meshes.entries();
  const auto add = [&](const PartOfPiece& read, const PartCounts& counts) {
    parts_.push_back(read);
    all_ += counts;
    largest_part_ = std::max(largest_part_, part_bytes(counts));
  };
  meshes.spans().each(begin, end, [&](std::size_t i) {
    if (!entries[i].summary.box.meets(box.box)) return;
    each_piece_of(*meshes.open(i), begin, end, [&](std::size_t p, const CubePieceRecord& piece) {
      const bool here = near.contains(morton_decode(piece.cube));
      const bool inside = piece.inside.triangles > 0 && here;
      const bool leaving = piece.leaving.triangles > 0 && piece.leaving_box.meets(box.box);
      const bool holes = piece.holes > 0 && here;
      if ((inside || leaving || holes) && (counted_.empty() || counted_.back() != i))
        counted_.push_back(i);
      if (inside) add({i, p, CubePart::inside}, piece.inside);
      if (leaving) add({i, p, CubePart::leaving}, piece.leaving);
    });
  });
}

// As the artifacts say that are read.
double BoxReads::triangles_near(const CubeLattice& blocks) const {
  double triangles = 0;
  for (const std::size_t artifact : counted_)
    for (const BlockRecord& block : meshes_.open(artifact)->blocks())
      if (block.label == box_.label)
        triangles += static_cast<double>(static_cast<std::int64_t>(block.triangles)) *
                     part_near(blocks.box(CellKey::of(block.code, tile_block_level).at), box_.box);
  return std::max(triangles, 0.0);
}

void BoxReads::limit(const CubeLattice& blocks) {
  if (all_.triangles <= most_part_triangles) return;
  const auto near = static_cast<std::uint64_t>(1.25 * triangles_near(blocks)) + (1 << 12);
  if (near >= all_.triangles) return;
  // What hangs on them is spread as they are, more or less.
  const double part =
      std::min(1.0, 1.25 * static_cast<double>(near) / static_cast<double>(all_.triangles));
  const auto scaled = [&](std::uint64_t count) {
    return static_cast<std::uint64_t>(part * static_cast<double>(count));
  };
  all_ = {scaled(all_.vertices), near, scaled(all_.samples), std::min(all_.sided, near)};
}

void BoxReads::add_hashes(KeyHasher& key) const {
  for (std::size_t a = 0; a < 3; ++a) key.integer(box_.box.lo[a]).integer(box_.box.hi[a]);
  for (const PartOfPiece& read : parts_)
    meshes_.add_hashes(key, read.artifact, read.piece, read.part);
}

HeldPart::HeldPart(RefineMesh part, const BoxTree& boxes) {
  const std::size_t count = part.triangles.size();
  const auto is_near = [&](const LatticeBox& box) {
    return boxes.any_meeting(box, [](std::uint32_t) { return true; });
  };
  std::vector<std::uint32_t> near;
  for (std::size_t first = 0; first < count; first += run) {
    const std::size_t end = std::min(first + run, count);
    if (!is_near(box_of_run(part, first, end))) continue;
    for (std::size_t t = first; t < end; ++t)
      if (is_near(part.box(t))) near.push_back(static_cast<std::uint32_t>(t));
  }
  // A copy of nearly all is not worth it.
  mesh_ = near.size() < count / 4 * 3 ? Extract(part).of(near) : std::move(part);
  const std::size_t held = mesh_.triangles.size();
  around_.reserve((held + run - 1) / run);
  for (std::size_t first = 0; first < held; first += run)
    around_.push_back(box_of_run(mesh_, first, std::min(first + run, held)));
}

std::vector<std::uint32_t> HeldPart::meeting(const LatticeBox& box) const {
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < around_.size(); ++i) {
    if (!around_[i].meets(box)) continue;
    const std::size_t end = std::min((i + 1) * run, mesh_.triangles.size());
    for (std::size_t t = i * run; t < end; ++t)
      if (mesh_.box(t).meets(box)) found.push_back(static_cast<std::uint32_t>(t));
  }
  return found;
}

const HeldPart& HeldParts::get(const PartOfPiece& part) {
  if (const auto kept = parts_.find(part); kept != parts_.end()) return kept->second;
  if (const auto held = others_.find(part); held != others_.end()) return held->second;
  HeldPart other = read(part);
  const std::uint64_t bytes = bytes_of(counts_of(other.mesh()));
  if (others_bytes_ + bytes > most_others_bytes) {
    others_.clear();
    others_bytes_ = 0;
  }
  others_bytes_ += bytes;
  return others_.emplace(part, std::move(other)).first->second;
}

// A box is mostly much smaller than the pieces that it reaches into: so there is room for what meets it.
RefineMesh BoxReads::read(HeldParts& held, const std::function<void()>& between) const {
  std::vector<std::vector<std::uint32_t>> meeting;
  std::uint64_t triangles = 0;
  for (const PartOfPiece& part : parts_) {
    between();
    triangles += meeting.emplace_back(held.get(part).meeting(box_.box)).size();
  }
  MeshGather mesh;
  const double share = static_cast<double>(triangles) /
                       static_cast<double>(std::max<std::uint64_t>(all_.triangles, 1));
  mesh.reserve(std::min(all_.vertices, triangles + 64), triangles,
               static_cast<std::uint64_t>(share * static_cast<double>(all_.samples)),
               all_.sided > 0 ? triangles : 0);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    between();
    if (!meeting[i].empty()) mesh.add(held.get(parts_[i]).mesh(), meeting[i]);
  }
  return mesh.take();
}

}  // namespace voxweld
