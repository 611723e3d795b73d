#include "pipeline/build/shard_octrees.h"

#include <algorithm>
#include <stdexcept>

#include "pipeline/build/piece_note.h"
#include "pipeline/stage/shard_memory.h"
#include "stages/merge/shard_reduction.h"
#include "storage/artifact/node_record_bytes.h"

namespace voxweld {
ShardOctrees::ShardOctrees(const BuildJob& job, MemoryShare& share)
    : job_(job), bricks_(job, share), share_(share), notes_(job.folder, material_notes_bytes) {}

void ShardOctrees::free_buffers() {
  bricks_.free_buffers();
  cut_ = finer_ = {};
  cutter_ = {};
}

void ShardOctrees::begin(Index3 shard, Hash128 input_stamp) {
  shard_ = shard;
  notes_.clear();
  summary_ = ShardSummary{};
  history_ = ShardHistory{};
  out_.reset();
  out_ = std::make_unique<ShardArtifactWriter>(shard_artifact_path(job_, shard),
                                               shard_key(job_, shard), input_stamp);
}

void ShardOctrees::build(const BricksToBuild& bricks, const WorkerContext& worker) {
  bricks_.build(bricks, worker, *this);
}

void ShardOctrees::build(const BricksToBuild& bricks, const WorkerContext& worker, BrickSink& out) {
  bricks_.build(bricks, worker, out);
}

void ShardOctrees::add_run(const RunPieces& run) {
  for (const PiecesOfBrick& brick : run.bricks) {
    if (!brick.section.empty()) out_->brick(brick.built.code, brick.section);
    for (const PiecesOfBrick::Note& piece : brick.notes)
      notes_.push({piece.key.material, piece.key.brick}, piece.bytes);
    note(brick.built, brick.surface);
  }
}

void ShardOctrees::begin_brick(Index3 brick) {
  brick_ = {morton_encode(brick), brick_key(job_, brick), {}};
  any_ = surface_ = false;
}

void ShardOctrees::put(Material material, const BrickOctree& octree) {
  add_brick(brick_.counts, octree.counts, octree.root.state);
  if (octree.root.state == NodeState::outside) return;
  if (!any_) out_->begin_brick(brick_.code);
  any_ = true;
  const std::vector<FilledBlock> blocks = filled_blocks(octree.blocks);
  put_above(octree, above_);
  const PieceHead head = out_->piece(material, octree, blocks, above_);
  surface_ = surface_ || has_surface(head);
  note(head, blocks, above_.record());
}

void ShardOctrees::end_brick() {
  if (any_) out_->end_brick();
  note(brick_, surface_);
  share_.yield();
}

std::uint64_t ShardOctrees::cut(Index3 brick, const BuiltBrick& built, const ArtifactReader& from) {
  begin_brick(brick);
  brick_.counts.active_cells = built.counts.active_cells;
  brick_.counts.crossing_edges = built.counts.crossing_edges;
  std::uint64_t bytes = 0;
  each_piece_in(from, built.code, [&](const PieceHead& head) {
    bytes += head.piece.bytes();
    share_.reserve(cut_bytes(head.piece.bytes()));
    read_octree(from, head, job_.grid.brick_level(), finer_);
    if (!has_surface(head)) return put(head.piece.key.material, finer_);
    if (!can_be_cut(finer_)) from.damaged("the parts of a piece contradict each other");
    cutter_.cut(finer_, job_.parameters.simplify.tolerance, cut_);
    put(head.piece.key.material, cut_);
  });
  end_brick();
  return bytes;
}

void ShardOctrees::keep(Index3, const BuiltBrick& built, const ArtifactReader& from) {
  bool surface = false;
  out_->brick(built.code, from, [&](const PieceBytes& piece) {
    surface = surface || has_surface(piece.head);
    note(piece.head, piece.blocks(), piece.record());
  });
  note(built, surface);
}

void ShardOctrees::note(const BuiltBrick& built, bool surface) {
  add(summary_.counts, built.counts);
  if (surface) ++summary_.active_bricks;
  history_.bricks.push_back(built);
}

void ShardOctrees::inside(Index3 brick, Material material) {
  PieceHead head;
  head.root = filled_brick().root;
  if (job_.parameters.labels.mode == LabelMode::shared) {
    head.root.corner_signs = 0;
    head.root.corners.fill(material);
  }
  const bool of_label = job_.parameters.labels.mode == LabelMode::each;
  head.piece.key = {of_label ? material : sole_material, morton_encode(brick)};
  note(head, {}, {});
}

void ShardOctrees::note(const PieceHead& head, std::span<const FilledBlock> blocks,
                        std::span<const std::byte> record) {
  put_note(head, blocks, record, note_);
  notes_.push({head.piece.key.material, head.piece.key.brick}, note_);
}

// The nodes of one material after the other, and in each its cubes, as the notes come.
class ShardOctrees::NodeWriter {
 public:
  NodeWriter(const BuildJob& job, ShardSummary& summary, ShardArtifactWriter& out)
      : job_(job), summary_(summary), out_(out) {}

  void add_note(Material material, const CellKey& brick, std::span<const std::byte> bytes) {
    open(material, brick);
    const PieceNote note = note_of(bytes);
    if (has_surface(note.head)) add_piece(note.head.piece);
    reduction_->add(brick, note.head.root, note.head.piece.polygons, note.blocks);
    if (!note.head.piece.by_sheets()) return;
    node_.final_vertices += note.head.piece.final_vertices;
    NodeRecord record;
    if (!RecordBytes(note.record).take(record))
      throw std::logic_error("build: a note of a piece has no record");
    reduction_->add_record(brick, record);
  }

  // After the last, and between one cube and the next.
  void close() {
    if (!reduction_) return;
    node_.node = reduction_->finish();
    if (collapses_by_sheets(job_.parameters)) node_.final_vertices += reduction_->counts().vertices;
    add(summary_.counts, reduction_->counts());
    summary_.collapsed_above += reduction_->collapsed();
    content_->bytes(std::as_bytes(std::span(node_.node.leaves)));
    if (node_.node.clusters.record.has_surface()) {
      std::vector<std::byte> links;
      put_links(node_.node.clusters, links);
      content_->bytes(links);
    }
    node_.content = content_->finish();
    out_.node(node_);
    reduction_.reset();
  }

 private:
  void open(Material material, const CellKey& brick) {
    const int up = job_.grid.shard_level() - brick.level;
    const CellKey cube{job_.grid.shard_level(),
                       {brick.at.x >> up, brick.at.y >> up, brick.at.z >> up}};
    if (reduction_ && node_.material == material && cube_ == cube) return;
    close();
    node_ = {};
    node_.material = material;
    cube_ = cube;
    content_.emplace();
    reduction_.emplace(job_.grid, cube, job_.parameters);
  }

  void add_piece(const PieceRecord& piece) {
    out_.directory(piece);
    node_.largest_piece = std::max(node_.largest_piece, piece.stitched_bytes());
    content_->integer(static_cast<std::int64_t>(piece.key.brick))
        .hash(piece.body)
        .hash(piece.ghost);
  }

  const BuildJob& job_;
  ShardSummary& summary_;
  ShardArtifactWriter& out_;
  MaterialNode node_;  // under way
  CellKey cube_;       // of it
  std::optional<KeyHasher> content_;
  std::optional<CubeReduction> reduction_;
};

void ShardOctrees::finish(Hash128 input, std::vector<BuiltRun> runs, std::uint64_t unread) {
  summary_.bricks = static_cast<std::uint64_t>(job_.grid.shard_bricks(shard_).count());
  summary_.input = input;
  summary_.unread = unread;
  history_.runs = std::move(runs);
  NodeWriter nodes(job_, summary_, *out_);
  SortKey key;
  while (notes_.next(key, note_))
    nodes.add_note(key.major, {job_.grid.brick_level(), morton_decode(key.minor)}, note_);
  nodes.close();
  out_->finish(summary_, history_);
  out_.reset();
  notes_.clear();
}

}  // namespace voxweld
