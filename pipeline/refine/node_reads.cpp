#include "pipeline/refine/node_reads.h"

#include <fmt/format.h>

#include <algorithm>

#include "stages/refine/mesh_part.h"
#include "storage/support/error.h"

namespace voxweld {

NodeChildren::NodeChildren(const NodeSources& sources, std::uint64_t node)
    : of_(sources.tree.nodes()[node].name()) {
  for (const std::uint64_t child : sources.tree.nodes()[node].nodes)
    paths_.push_back(level_artifact_path(sources.job.folder, sources.tree.nodes()[child]));
}

bool NodeChildren::are_there() const {
  return std::ranges::all_of(paths_,
                             [](const auto& path) { return std::filesystem::exists(path); });
}

std::shared_ptr<const CubeMeshArtifact> NodeChildren::open(std::size_t child) const {
  const std::filesystem::path& path = paths_[child];
  return open_.get(child, [&] {
    if (!std::filesystem::exists(path))
      throw InputError(fmt::format(
          "{}: is missing, which tile {} of the next level is made of; run `voxweld levels CONFIG` "
          "again once the shares that others do of it are done",
          path.string(), of_));
    return std::make_shared<const CubeMeshArtifact>(path);
  });
}

NodeReads::NodeReads(const NodeSources& sources, std::uint64_t node, const LevelSurface& surface,
                     const NodeChildren& children)
    : sources_(sources),
      node_(sources.tree.nodes()[node]),
      surface_(surface),
      children_(children),
      box_(CubeLattice(sources.job.frame, 0, node_.cell.level).box(node_.cell.at)) {
  find_own();
  if (!surface_.all) find_others();
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
  const CubeKey begin{surface_.label, range.begin}, end{surface_.label, range.end};
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
  each_piece(surface_.all ? CubeRange{} : cubes_of(node_.cell), keep(all_));
  // Tiles may be smaller than cubes: then they are all that the node has.
  if (node_.nodes.empty()) {
    own_ = all_;
    return;
  }
  std::uint64_t done = 0;  // before this cube
  for (const std::uint64_t leaf : surface_.leaves) {
    const LevelLeaf& own = sources_.tree.leaves()[leaf];
    if (own.whole) {
      own_ = all_;
      return;
    }
    const CubeRange cubes = cubes_of(own.place);
    if (cubes.begin < done) continue;  // another small tile in the same cube
    each_piece(cubes, keep(own_));
    done = cubes.end;
  }
}

void NodeReads::find_others() {
  CubeMeshes& meshes = sources_.meshes;
  const CubeRange own = cubes_of(node_.cell);
  const CubeKey begin{surface_.label, 0}, end{surface_.label, CubeRange{}.end};
  const auto& entries = meshes.entries();
  meshes.spans().each(begin, end, [&](std::size_t i) {
    const CubeMeshSummary& summary = entries[i].summary;
    if (summary.leaving == 0 || !summary.leaving_box.meets(box_)) return;
    each_piece_of(*meshes.open(i), begin, end, [&](std::size_t p, const CubePieceRecord& piece) {
      if (!own.contains(piece.code) && piece.leaving.triangles > 0 && piece.leaving_box.meets(box_))
        others_.push_back({i, p});
    });
  });
}

template <class F>
void NodeReads::each_child_piece(F&& f) const {
  const CubeKey begin{surface_.label, 0}, end{surface_.label, CubeRange{}.end};
  children_.each([&](const CubeMeshArtifact& child) {
    each_piece_of(child, begin, end,
                  [&](std::size_t p, const CubePieceRecord& piece) { f(child, p, piece); });
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
  each_child_piece([&](const CubeMeshArtifact&, std::size_t, const CubePieceRecord& piece) {
    sum += piece.inside;
    sum += piece.leaving;
  });
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
  each_child_piece(
      [&](const CubeMeshArtifact&, std::size_t, const CubePieceRecord& piece) { see(piece); });
  return most;
}

RefineMesh NodeReads::read(const std::function<void()>& between) const {
  CubeMeshes& meshes = sources_.meshes;
  std::vector<PartRead> parts;
  for (const Piece& piece : own_)
    add_parts({piece.artifact, piece.piece, true},
              meshes.open(piece.artifact)->pieces()[piece.piece], parts);
  for (const Piece& piece : others_)
    add_parts({piece.artifact, piece.piece, false},
              meshes.open(piece.artifact)->pieces()[piece.piece], parts);
  std::uint64_t shared = put_in_order(parts);
  each_child_piece([&](const CubeMeshArtifact&, std::size_t, const CubePieceRecord& piece) {
    shared += piece.leaving.vertices;
  });
  MeshGather mesh;
  const PartCounts all = counts();
  mesh.reserve(all.vertices, all.triangles, all.samples, all.sided, shared);
  // What leaves its cube comes first, children's too.
  auto part = parts.begin();
  for (; part != parts.end() && part->part == CubePart::leaving; ++part) {
    between();
    const RefineMesh leaving =
        meshes.read(part->piece.artifact, part->piece.piece, CubePart::leaving);
    if (part->piece.whole)
      mesh.add(leaving);
    else
      mesh.add(leaving, [&](std::size_t t) { return leaving.box(t).meets(box_); });
  }
  each_child_piece([&](const CubeMeshArtifact& child, std::size_t p, const CubePieceRecord&) {
    mesh.add(child.read(p, CubePart::leaving));
  });
  for (; part != parts.end(); ++part) {
    between();
    const RefineMesh inside =
        meshes.read(part->piece.artifact, part->piece.piece, CubePart::inside);
    if (part->last)
      mesh.add_last(inside);
    else
      mesh.add(inside);
  }
  each_child_piece([&](const CubeMeshArtifact& child, std::size_t p, const CubePieceRecord&) {
    between();
    mesh.add_last(child.read(p, CubePart::inside));
  });
  return mesh.take();
}

}  // namespace voxweld
