#include "pipeline/refine/cube_meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include "pipeline/executor/probe.h"
#include "stages/refine/mesh_part.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

bool meets_any(const LatticeBox& box, const std::vector<LatticeBox>& boxes) {
  return std::ranges::any_of(boxes, [&](const LatticeBox& other) { return box.meets(other); });
}

// What patches have taken much out of, in as little memory as it takes: without the vertices that nothing
// uses now.
RefineMesh compact(const RefineMesh& mesh) {
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0U);
  return Extract(mesh).of(all);
}

// Those of the boxes that meet one of them.
std::vector<LatticeBox> those_near(const std::vector<LatticeBox>& boxes, const LatticeBox& box) {
  std::vector<LatticeBox> near;
  std::ranges::copy_if(boxes, std::back_inserter(near),
                       [&](const LatticeBox& other) { return other.meets(box); });
  return near;
}

}  // namespace

void PieceSpans::add(std::uint64_t pieces, const CubeKey& lowest, const CubeKey& highest,
                     bool again) {
  if (again || spans_.empty()) runs_.push_back(std::ssize(spans_));
  const CubeKey before =
      runs_.back() == std::ssize(spans_) ? CubeKey{} : spans_.back().highest_so_far;
  spans_.push_back({pieces > 0, lowest, highest, pieces > 0 ? std::max(before, highest) : before});
}

CubeMeshes::CubeMeshes(std::vector<MeshLayer> layers) {
  for (std::size_t i = 0; i < layers.size(); ++i)
    for (std::filesystem::path& path : layers[i].paths)
      artifacts_.push_back({layers[i].maker, i, std::move(path)});
}

const std::vector<CubeMeshes::Entry>& CubeMeshes::entries() {
  std::call_once(looked_, [&] {
    std::vector<Entry> entries(size());
    probe_all(size(), [&](std::size_t i) {
      if (!std::filesystem::exists(path(i)))
        throw InputError(
            fmt::format("{}: is missing; run `voxweld {} CONFIG` first, or `voxweld "
                        "run CONFIG` for all",
                        path(i).string(), stage_name(artifacts_[i].maker)));
      const CubeMeshArtifact artifact(path(i));
      entries[i] = {artifact.summary(), artifact.content_hash(), artifact.intersecting_count(),
                    artifact.counts_triangles()};
    });
    entries_ = std::move(entries);
    for (std::size_t i = 0; i < size(); ++i) {
      const CubeMeshSummary& summary = entries_[i].summary;
      spans_.add(summary.pieces, summary.lowest, summary.highest, begins_layer(i));
    }
  });
  return entries_;
}

std::vector<Material> CubeMeshes::labels(Material first, Material end) {
  std::vector<Material> labels;
  spans().each({first, 0}, {end, 0}, [&](std::size_t i) {
    each_piece_of(*open(i), {first, 0}, {end, 0}, [&](std::size_t, const CubePieceRecord& piece) {
      labels.push_back(piece.label);
    });
  });
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  return labels;
}

std::shared_ptr<const CubeMeshArtifact> CubeMeshes::open(std::size_t artifact) {
  return open_.get(artifact,
                   [&] { return std::make_shared<const CubeMeshArtifact>(path(artifact)); });
}

template <class F>
void CubeMeshes::each_over(const PieceSpans& spans, std::size_t artifact,
                           const CubePieceRecord& piece, F&& f) {
  const std::size_t own = layer(artifact);
  if (own == artifacts_.back().layer) return;
  CubeKey end = piece.key();
  ++end.code;
  spans.each(piece.key(), end, [&](std::size_t i) {
    if (layer(i) <= own) return;
    const auto patch = open(i);
    each_piece_of(*patch, piece.key(), end, [&](std::size_t p, const CubePieceRecord& over) {
      if (over.cube == piece.cube && over.holes > 0) f(*patch, p);
    });
  });
}

RefineMesh CubeMeshes::read(const PieceSpans& spans, std::size_t artifact, std::size_t piece,
                            CubePart part, const PartFields& wanted) {
  const auto file = open(artifact);
  RefineMesh mesh = file->read(piece, part, wanted);
  const std::size_t before = mesh.triangles.size();
  if (before == 0) return mesh;
  each_over(
      spans, artifact, file->pieces()[piece],
      [&](const CubeMeshArtifact& patch, std::size_t p) { remove_inside(mesh, patch.holes(p)); });
  if (mesh.triangles.size() < before - before / 8) return compact(mesh);
  return mesh;
}

void CubeMeshes::add_hashes(KeyHasher& key, const PieceSpans& spans, std::size_t artifact,
                            std::size_t piece, CubePart part) {
  const auto file = open(artifact);
  key.hash(file->part_hash(piece, part));
  each_over(spans, artifact, file->pieces()[piece],
            [&](const CubeMeshArtifact& patch, std::size_t p) { key.hash(patch.holes_hash(p)); });
}

void add_parts(const PieceRead& read, const CubePieceRecord& piece, std::vector<PartRead>& parts) {
  if (piece.leaving.triangles > 0)
    parts.push_back({read, CubePart::leaving, piece.cube, piece.leaving.vertices, false});
  if (read.whole && piece.inside.triangles > 0)
    parts.push_back({read, CubePart::inside, piece.cube, piece.inside.vertices, false});
}

std::uint64_t put_in_order(std::vector<PartRead>& parts) {
  // Triangles inside a cube have vertices in common with others inside that cube, and with some that
  // leave one. The largest part of a cube comes last: patches are small.
  std::ranges::stable_sort(parts, {}, [](const PartRead& part) {
    return std::tuple(part.part == CubePart::inside, part.cube, part.vertices);
  });
  std::uint64_t shared = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].last = parts[i].part == CubePart::inside &&
                    (i + 1 == parts.size() || parts[i + 1].cube != parts[i].cube);
    if (!parts[i].last) shared += parts[i].vertices;
  }
  return shared;
}

std::vector<PartRead> parts_of(CubeMeshes& meshes, const std::vector<PieceRead>& pieces) {
  std::vector<PartRead> parts;
  for (const PieceRead& read : pieces)
    add_parts(read, meshes.open(read.artifact)->pieces()[read.piece], parts);
  return parts;
}

RangeReads::RangeReads(CubeMeshes& meshes, const CubeLattice& cubes, Material label,
                       const CubeRange& own)
    : meshes_(meshes), label_(label) {
  add_own(cubes, own);
  const bool all = own.begin == 0 && own.end == CubeRange{}.end;
  if (!near_.empty() && !all) add_others(own);
}

void RangeReads::add(const PieceRead& read, const CubePieceRecord& piece) {
  pieces_.push_back(read);
  all_ += piece.leaving;
  largest_part_ = std::max(largest_part_, part_bytes(piece.leaving));
  if (!read.whole) return;
  all_ += piece.inside;
  own_ += piece.inside;
  own_ += piece.leaving;
  largest_part_ = std::max(largest_part_, part_bytes(piece.inside));
}

void RangeReads::add_own(const CubeLattice& cubes, const CubeRange& own) {
  const CubeKey begin{label_, own.begin}, end{label_, own.end};
  meshes_.spans().each(begin, end, [&](std::size_t i) {
    each_piece_of(*meshes_.open(i), begin, end, [&](std::size_t p, const CubePieceRecord& piece) {
      add({i, p, true}, piece);
      near_.push_back(cubes.box(morton_decode(piece.cube)));
      if (piece.leaving.triangles > 0) near_.push_back(piece.leaving_box);
    });
  });
}

void RangeReads::add_others(const CubeRange& own) {
  LatticeBox reach = near_.front();
  for (const LatticeBox& box : near_) reach.extend(box);
  const CubeKey begin{label_, 0}, end{label_, CubeRange{}.end};
  const auto& entries = meshes_.entries();
  meshes_.spans().each(begin, end, [&](std::size_t i) {
    const CubeMeshSummary& summary = entries[i].summary;
    if (summary.leaving == 0 || !summary.leaving_box.meets(reach)) return;
    each_piece_of(*meshes_.open(i), begin, end, [&](std::size_t p, const CubePieceRecord& piece) {
      if (!own.contains(piece.code) && piece.leaving.triangles > 0 &&
          piece.leaving_box.meets(reach) && meets_any(piece.leaving_box, near_))
        add({i, p, false}, piece);
    });
  });
}

void RangeReads::add_hashes(KeyHasher& key) const {
  for (const PieceRead& read : pieces_) {
    key.integer(static_cast<std::int64_t>(meshes_.open(read.artifact)->pieces()[read.piece].cube));
    if (read.whole) meshes_.add_hashes(key, read.artifact, read.piece, CubePart::inside);
    meshes_.add_hashes(key, read.artifact, read.piece, CubePart::leaving);
  }
}

RefineMesh RangeReads::read(const std::function<void()>& between, const PartFields& wanted) const {
  MeshGather mesh;
  std::vector<PartRead> parts = parts_of(meshes_, pieces_);
  const std::uint64_t shared = put_in_order(parts);
  mesh.reserve(all_.vertices, all_.triangles, all_.samples, all_.sided, shared);
  for (const PartRead& part : parts) {
    between();
    const PieceRead& piece = part.piece;
    const RefineMesh triangles = meshes_.read(piece.artifact, piece.piece, part.part, wanted);
    if (part.last) {
      mesh.add_last(triangles);
    } else if (piece.whole) {
      mesh.add(triangles);
    } else {
      const auto near =
          those_near(near_, meshes_.open(piece.artifact)->pieces()[piece.piece].leaving_box);
      mesh.add(triangles, [&](std::size_t t) { return meets_any(triangles.box(t), near); });
    }
  }
  return mesh.take();
}

std::uint64_t part_bytes(const PartCounts& counts) {
  return 2 * (counts.vertices * (12 + 8 + 12 + 12) + counts.triangles * 12 + counts.samples * 16 +
              counts.sided * sizeof(MaterialPair));
}

}  // namespace voxweld
