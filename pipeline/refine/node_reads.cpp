#include "pipeline/refine/node_reads.h"

#include <fmt/format.h>

#include <algorithm>

#include "stages/refine/mesh_part.h"
#include "storage/support/error.h"

namespace voxweld {

NodeReads::NodeReads(const NodeSources& sources, std::uint64_t node)
    : sources_(sources),
      node_(sources.tree.nodes()[node]),
      box_(CubeLattice(sources.job.frame, 0, node_.cell.level).box(node_.cell.at)) {
  find_own();
  if (!node_.all) find_others();
}

CubeRange NodeReads::cubes_of(CellKey cell) const {
  const int level = sources_.job.frame.level;
  while (cell.level < level) cell = cell.parent();
  const std::uint64_t begin = cell.code() >> (3 * level);
  return {begin, begin + (std::uint64_t{1} << (3 * (cell.level - level)))};
}

template <class F>
void NodeReads::each_piece(const CubeRange& range, F&& f) const {
  CubeMeshes& meshes = sources_.meshes;
  const CubeKey begin{0, range.begin}, end{0, range.end};
  meshes.spans().each(begin, end, [&](std::size_t i) {
    each_piece_of(*meshes.open(i), begin, end, [&](std::size_t p, const CubePieceRecord& piece) {
      f(Piece{i, p}, piece);
    });
  });
}

void NodeReads::find_own() {
  const auto keep = [](std::vector<Piece>& pieces) {
    return [&pieces](const Piece& piece, const CubePieceRecord&) { pieces.push_back(piece); };
  };
  const CubeRange whole = node_.all ? CubeRange{} : cubes_of(node_.cell);
  each_piece(whole, keep(all_));
  // Tiles may be smaller than cubes: then they are all that the node has.
  if (node_.nodes.empty()) {
    own_ = all_;
    return;
  }
  const LevelTree& tree = sources_.tree;
  for (const std::uint64_t tile : node_.tiles) each_piece(cubes_of(tree.tile(tile)), keep(own_));
}

void NodeReads::find_others() {
  CubeMeshes& meshes = sources_.meshes;
  const CubeRange own = cubes_of(node_.cell);
  const auto& entries = meshes.entries();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const CubeMeshSummary& summary = entries[i].summary;
    if (summary.leaving == 0 || !summary.leaving_box.meets(box_)) continue;
    const auto artifact = meshes.open(i);
    const auto pieces = artifact->pieces();
    for (std::size_t p = 0; p < pieces.size(); ++p)
      if (!own.contains(pieces[p].code) && pieces[p].leaving.triangles > 0 &&
          pieces[p].leaving_box.meets(box_))
        others_.push_back({i, p});
  }
}

template <class F>
void NodeReads::each_child(F&& f) const {
  for (const std::uint64_t child : node_.nodes) {
    const auto path = level_artifact_path(sources_.job.folder, sources_.tree.nodes()[child]);
    if (!std::filesystem::exists(path))
      throw InputError(fmt::format(
          "{}: is missing, which tile {} of the next level is made of; run `voxweld levels CONFIG` "
          "again once the shares that others do of it are done",
          path.string(), node_.name()));
    f(CubeMeshArtifact(path));
  }
}

bool NodeReads::children_are_there() const {
  return std::ranges::all_of(node_.nodes, [&](std::uint64_t child) {
    return std::filesystem::exists(
        level_artifact_path(sources_.job.folder, sources_.tree.nodes()[child]));
  });
}

void NodeReads::add_hashes(KeyHasher& key) const {
  CubeMeshes& meshes = sources_.meshes;
  for (const Piece& piece : all_)
    for (const CubePart part : {CubePart::inside, CubePart::leaving})
      meshes.add_hashes(key, piece.artifact, piece.piece, part);
  key.integer(static_cast<std::int64_t>(all_.size()));
  for (const Piece& piece : others_)
    meshes.add_hashes(key, piece.artifact, piece.piece, CubePart::leaving);
}

PartCounts NodeReads::counts() const {
  PartCounts sum;
  const auto record = [&](const Piece& piece) {
    return sources_.meshes.open(piece.artifact)->pieces()[piece.piece];
  };
  for (const Piece& piece : own_) {
    sum += record(piece).inside;
    sum += record(piece).leaving;
  }
  for (const Piece& piece : others_) sum += record(piece).leaving;
  each_child([&](const CubeMeshArtifact& child) { sum += child.summary().all; });
  return sum;
}

std::uint64_t NodeReads::largest_part_bytes() const {
  std::uint64_t most = 0;
  const auto see = [&](const CubePieceRecord& piece) {
    most = std::max({most, part_bytes(piece.inside), part_bytes(piece.leaving)});
  };
  for (const std::vector<Piece>* const pieces : {&own_, &others_})
    for (const Piece& piece : *pieces)
      see(sources_.meshes.open(piece.artifact)->pieces()[piece.piece]);
  each_child([&](const CubeMeshArtifact& child) { std::ranges::for_each(child.pieces(), see); });
  return most;
}

RefineMesh NodeReads::read(const std::function<void()>& between) const {
  MeshGather mesh;
  const PartCounts all = counts();
  mesh.reserve(all.vertices, all.triangles, all.samples, all.sided);
  for (const Piece& piece : own_) {
    between();
    for (const CubePart part : {CubePart::inside, CubePart::leaving})
      mesh.add(sources_.meshes.read(piece.artifact, piece.piece, part));
  }
  each_child([&](const CubeMeshArtifact& child) {
    for (std::size_t p = 0; p < child.pieces().size(); ++p) {
      between();
      mesh.add(child.read(p, CubePart::inside));
      mesh.add(child.read(p, CubePart::leaving));
    }
  });
  for (const Piece& piece : others_) {
    between();
    const RefineMesh leaving = sources_.meshes.read(piece.artifact, piece.piece, CubePart::leaving);
    mesh.add(leaving, [&](std::size_t t) { return leaving.box(t).meets(box_); });
  }
  return mesh.take();
}

}  // namespace voxweld
