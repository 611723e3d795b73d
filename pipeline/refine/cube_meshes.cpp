#include "pipeline/refine/cube_meshes.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/executor/probe.h"
#include "stages/refine/mesh_part.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

bool meets_any(const LatticeBox& box, const std::vector<LatticeBox>& boxes) {
  return std::ranges::any_of(boxes, [&](const LatticeBox& other) { return box.meets(other); });
}

// Those of the boxes that meet one of them.
std::vector<LatticeBox> those_near(const std::vector<LatticeBox>& boxes, const LatticeBox& box) {
  std::vector<LatticeBox> near;
  std::ranges::copy_if(boxes, std::back_inserter(near),
                       [&](const LatticeBox& other) { return other.meets(box); });
  return near;
}

}  // namespace

const std::vector<CubeMeshes::Entry>& CubeMeshes::entries() {
  std::call_once(looked_, [&] {
    std::vector<Entry> entries(paths_.size());
    probe_all(paths_.size(), [&](std::size_t i) {
      if (!std::filesystem::exists(paths_[i]))
        throw InputError(
            fmt::format("{}: is missing; run `voxweld {} CONFIG` first, or `voxweld "
                        "run CONFIG` for all",
                        paths_[i].string(), stage_name(maker_)));
      const CubeMeshArtifact artifact(paths_[i]);
      entries[i] = {artifact.summary(), artifact.content_hash()};
    });
    entries_ = std::move(entries);
  });
  return entries_;
}

std::shared_ptr<const CubeMeshArtifact> CubeMeshes::open(std::size_t artifact) {
  return open_.get(artifact,
                   [&] { return std::make_shared<const CubeMeshArtifact>(paths_[artifact]); });
}

RangeReads::RangeReads(CubeMeshes& meshes, const CubeLattice& cubes, const CubeRange& own)
    : meshes_(meshes) {
  add_own(cubes, own);
  if (!near_.empty()) add_others(own);
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
  const auto& entries = meshes_.entries();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const CubeMeshSummary& summary = entries[i].summary;
    if (summary.pieces == 0 || summary.highest_code < own.begin || own.end <= summary.lowest_code)
      continue;
    const auto artifact = meshes_.open(i);
    const auto pieces = artifact->pieces();
    const auto code = [](const CubePieceRecord& piece) { return piece.code; };
    auto piece = std::ranges::lower_bound(pieces, own.begin, {}, code);
    for (; piece != pieces.end() && own.contains(piece->code); ++piece) {
      add({i, static_cast<std::size_t>(piece - pieces.begin()), true}, *piece);
      near_.push_back(cubes.box(morton_decode(piece->cube)));
      if (piece->leaving.triangles > 0) near_.push_back(piece->leaving_box);
    }
  }
}

void RangeReads::add_others(const CubeRange& own) {
  LatticeBox reach = near_.front();
  for (const LatticeBox& box : near_) reach.extend(box);
  const auto& entries = meshes_.entries();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const CubeMeshSummary& summary = entries[i].summary;
    if (summary.leaving == 0 || !summary.leaving_box.meets(reach)) continue;
    const auto artifact = meshes_.open(i);
    const auto pieces = artifact->pieces();
    for (std::size_t p = 0; p < pieces.size(); ++p)
      if (!own.contains(pieces[p].code) && pieces[p].leaving.triangles > 0 &&
          pieces[p].leaving_box.meets(reach) && meets_any(pieces[p].leaving_box, near_))
        add({i, p, false}, pieces[p]);
  }
}

void RangeReads::add_hashes(KeyHasher& key) const {
  for (const PieceRead& read : pieces_) {
    const auto artifact = meshes_.open(read.artifact);
    key.integer(static_cast<std::int64_t>(artifact->pieces()[read.piece].cube));
    if (read.whole) key.hash(artifact->part_hash(read.piece, CubePart::inside));
    key.hash(artifact->part_hash(read.piece, CubePart::leaving));
  }
}

RefineMesh RangeReads::read(const std::function<void()>& between) const {
  MeshGather mesh;
  mesh.reserve(all_.vertices, all_.triangles, all_.samples);
  for (const PieceRead& read : pieces_) {
    between();
    const auto artifact = meshes_.open(read.artifact);
    const RefineMesh leaving = artifact->read(read.piece, CubePart::leaving);
    if (read.whole) {
      mesh.add(artifact->read(read.piece, CubePart::inside));
      mesh.add(leaving);
      continue;
    }
    const auto near = those_near(near_, artifact->pieces()[read.piece].leaving_box);
    mesh.add(leaving, [&](std::size_t t) { return meets_any(leaving.box(t), near); });
  }
  return mesh.take();
}

std::uint64_t part_bytes(const PartCounts& counts) {
  return 2 * (counts.vertices * (12 + 8 + 12 + 12) + counts.triangles * 12 + counts.samples * 16);
}

}  // namespace voxweld
