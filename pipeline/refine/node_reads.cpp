#include "pipeline/refine/node_reads.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "stages/refine/mesh_part.h"
#include "stages/refine/sample_choice.h"
#include "storage/support/error.h"
#include "storage/support/parallel.h"

namespace voxweld {
namespace {

using Child = std::shared_ptr<const CubeMeshArtifact>;

// Parts that are read and wait to be put together take no more, unless it is one alone.
constexpr std::uint64_t bytes_at_once = std::uint64_t{4} << 20;
constexpr std::size_t most_at_once = 8;

}  // namespace

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
  children_.each([&](const Child& child) {
    each_piece_of(*child, begin, end,
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
  each_child_piece([&](const Child&, std::size_t, const CubePieceRecord& piece) {
    sum += piece.inside;
    sum += piece.leaving;
  });
  return sum;
}

// A part of a piece of the mesh itself, or of a child that is a node.
struct NodeReads::Part {
  PartRead read;
  Child child;
  PartCounts counts;
  std::uint64_t bytes() const { return part_bytes(counts); }
};

// In the order in which one mesh is made of them soonest: what leaves its cube comes first.
std::vector<NodeReads::Part> NodeReads::parts() const {
  CubeMeshes& meshes = sources_.meshes;
  const auto record = [&](const auto& piece) {
    return meshes.open(piece.artifact)->pieces()[piece.piece];
  };
  std::vector<PartRead> own;
  for (const Piece& piece : own_)
    add_parts({piece.artifact, piece.piece, true}, record(piece), own);
  for (const Piece& piece : others_)
    add_parts({piece.artifact, piece.piece, false}, record(piece), own);
  put_in_order(own);
  std::vector<Part> parts;
  for (const CubePart where : {CubePart::leaving, CubePart::inside}) {
    const bool inside = where == CubePart::inside;
    const auto counts = [&](const CubePieceRecord& piece) {
      return inside ? piece.inside : piece.leaving;
    };
    for (const PartRead& read : own)
      if (read.part == where) parts.push_back({read, nullptr, counts(record(read.piece))});
    each_child_piece([&](const Child& child, std::size_t p, const CubePieceRecord& piece) {
      const PartCounts some = counts(piece);
      if (some.triangles > 0)
        parts.push_back({{{0, p, true}, where, piece.cube, some.vertices, inside}, child, some});
    });
  }
  return parts;
}

std::uint64_t NodeReads::parts_bytes() const {
  std::uint64_t most = 0, all = 0;
  for (const Part& part : parts()) {
    most = std::max(most, part.bytes());
    all += part.bytes();
  }
  return std::max(most, std::min(all, bytes_at_once));
}

RefineMesh NodeReads::read(const Part& part) const {
  const PieceRead& piece = part.read.piece;
  return part.child != nullptr ? part.child->read(piece.piece, part.read.part)
                               : sources_.meshes.read(piece.artifact, piece.piece, part.read.part);
}

RefineMesh NodeReads::read(double tolerance, const std::function<void()>& between) const {
  const std::vector<Part> parts = this->parts();
  std::uint64_t shared = 0;
  PartCounts all;
  for (const Part& part : parts) {
    all += part.counts;
    if (!part.read.last) shared += part.read.vertices;
  }
  MeshGather mesh;
  mesh.reserve(all.vertices, all.triangles, std::min(all.samples, all.triangles), all.sided,
               shared);
  std::array<RefineMesh, most_at_once> waiting;
  const auto size = [&](std::size_t i) { return parts[i].bytes(); };
  const auto work = [&](std::size_t i, std::size_t slot) {
    between();
    waiting[slot] = read(parts[i]);
    thin_samples(waiting[slot], tolerance);
  };
  const auto put = [&](std::size_t i, std::size_t slot) {
    const RefineMesh part = std::exchange(waiting[slot], {});
    if (parts[i].read.last)
      mesh.add_last(part);
    else if (parts[i].read.piece.whole)
      mesh.add(part);
    else
      mesh.add(part, [&](std::size_t t) { return part.box(t).meets(box_); });
  };
  for_each_in_order({parts.size(), size, work, put}, most_at_once, bytes_at_once);
  return mesh.take();
}

}  // namespace voxweld
