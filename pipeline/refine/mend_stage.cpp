#include "pipeline/refine/mend_stage.h"

#include <algorithm>
#include <tuple>

#include "pipeline/refine/box_reads.h"
#include "pipeline/refine/range_stage.h"
#include "stages/refine/mend_box.h"
#include "stages/refine/mesh_part.h"
#include "stages/refine/retile.h"

namespace voxweld {
namespace {

using Place = std::pair<std::uint64_t, std::uint64_t>;  // of a piece of one label: code and cube

struct OwnPiece {
  std::size_t artifact = 0, piece = 0;
  CubePieceRecord record;

  Place place() const { return {record.code, record.cube}; }
};

bool lies_in_any(const RefineMesh& mesh, std::size_t triangle, const std::vector<BoxReads>& boxes) {
  return std::ranges::any_of(boxes, [&](const BoxReads& reads) {
    return std::ranges::all_of(mesh.shape(triangle), [&](const LatticePoint& corner) {
      return reads.box().box.contains(corner);
    });
  });
}

class MendStage final : public RangeStage {
 public:
  explicit MendStage(const RefineInputs& inputs)
      : RangeStage(inputs), plan_(meshes_, job_.frame, cubes_), blocks_(tile_blocks(job_.frame)) {}

  bool done(std::uint64_t unit) override {
    const std::filesystem::path path = path_of(unit);
    return is_current(path, [&] { return CubeMeshArtifact(path).key() == key(unit, works(unit)); });
  }
  std::uint64_t bytes(std::uint64_t unit) override {
    std::uint64_t most = 0;
    for (const LabelWork& work : limited_works(unit)) most = std::max(most, bytes_of(work));
    return most;
  }
  void run(const Unit& unit, WorkerContext& worker) override {
    const std::vector<LabelWork> all = limited_works(unit.key);
    CubeMeshWriter file(path_of(unit.key), key(unit.key, all));
    Result result;
    for (const LabelWork& work : all) mend(unit.key, work, worker, file, result);
    file.finish({as_record(result.counts), result.blocks, result.changes, {}});
  }

 private:
  // Of one label the boxes that reach into the unit's cubes, and the pieces there that they reach.
  struct LabelWork {
    Material label = 0;
    std::vector<BoxReads> boxes;
    std::vector<OwnPiece> pieces;  // ascending by place; several may have the same
  };
  struct Result {
    RefineCounts counts;
    std::vector<BlockRecord> blocks;
    std::vector<LabelChange> changes;
  };

  CubeKey begin_of(std::uint64_t unit) const {
    return {units_[unit].first_label, range_of(unit).begin};
  }
  CubeKey end_of(std::uint64_t unit) const {
    return {units_[unit].end_label - 1, range_of(unit).end};
  }

  std::vector<LabelWork> works(std::uint64_t unit) {
    std::vector<LabelWork> works;
    for (const MendBox& box : plan_.boxes(begin_of(unit), end_of(unit))) {
      if (works.empty() || works.back().label != box.label) works.push_back({box.label, {}, {}});
      works.back().boxes.emplace_back(meshes_, cubes_, box);
    }
    for (LabelWork& work : works) find_pieces(unit, work);
    return works;
  }

  // For memory; a key does not ask how much there is.
  std::vector<LabelWork> limited_works(std::uint64_t unit) {
    std::vector<LabelWork> all = works(unit);
    for (LabelWork& work : all)
      for (BoxReads& reads : work.boxes) reads.limit(blocks_);
    return all;
  }

  void find_pieces(std::uint64_t unit, LabelWork& work) {
    std::vector<Box3> near;
    for (const BoxReads& reads : work.boxes) {
      const LatticeBox& box = reads.box().box;
      near.push_back({cubes_.cube_of(box.lo), cubes_.cube_of(box.hi) + splat(1)});
    }
    const CubeKey begin{work.label, range_of(unit).begin}, end{work.label, range_of(unit).end};
    meshes_.spans().each(begin, end, [&](std::size_t i) {
      each_piece_of(*meshes_.open(i), begin, end, [&](std::size_t p, const CubePieceRecord& piece) {
        const Index3 cube = morton_decode(piece.cube);
        if (std::ranges::any_of(near, [&](const Box3& box) { return box.contains(cube); }))
          work.pieces.push_back({i, p, piece});
      });
    });
    std::ranges::stable_sort(work.pieces, {}, &OwnPiece::place);
  }

  void mend(std::uint64_t unit, const LabelWork& work, const WorkerContext& worker,
            CubeMeshWriter& file, Result& result) {
    MeshGather gather;
    const PartCounts most = counts_after(work);
    gather.reserve(most.vertices, most.triangles, most.samples, most.sided);
    std::uint64_t lost = 0;
    for (const BoxReads& reads : work.boxes) {
      RefineCounts counts;
      const RefineMesh mended = mend_box(reads.read([&] { worker.check_interrupt(); }),
                                         reads.box().box, job_.parameters, counts);
      // Others do the same box where it reaches into theirs, and take what is at home there.
      gather.add(mended, [&](std::size_t t) {
        return range_of(unit).contains(cubes_.code(home_of(mended, t, cubes_)));
      });
      const CubeKey owner = reads.box().owner;
      if (owner < begin_of(unit) || !(owner < end_of(unit))) continue;
      result.counts.add(counts);
      lost += counts.collapses;  // each took a vertex
    }
    if (lost > 0) result.changes.push_back({work.label, lost});
    std::map<std::uint64_t, std::uint64_t> more;  // triangles of blocks, modulo 2^64
    for (const OwnPiece& own : work.pieces) {
      worker.check_interrupt();
      for (const CubePart part : {CubePart::inside, CubePart::leaving}) {
        const RefineMesh before = meshes_.open(own.artifact)->read(own.piece, part);
        for (const CubeCount& block : count_blocks(before, blocks_))
          more[block.code] -= block.polygons;
        gather.add(before, [&](std::size_t t) { return !lies_in_any(before, t, work.boxes); });
      }
    }
    const RefineMesh after = gather.take();
    for (const CubeCount& block : count_blocks(after, blocks_)) more[block.code] += block.polygons;
    for (const auto& [code, triangles] : more)
      if (triangles != 0) result.blocks.push_back({work.label, code, triangles});
    write_pieces(work, after, file);
  }

  // All that are there now, and an empty one where there was one and is none any more.
  void write_pieces(const LabelWork& work, const RefineMesh& mesh, CubeMeshWriter& file) const {
    auto before = work.pieces.begin();
    const auto pass = [&](auto&& is_before) {
      for (; before != work.pieces.end() && is_before(before->place());) {
        const Place place = before->place();
        file.piece({work.label, place.first}, morton_decode(place.second), {}, {});
        while (before != work.pieces.end() && before->place() == place) ++before;
      }
    };
    each_piece(mesh, cubes_, [&](const CubePiece& piece) {
      const Place place{piece.code, morton_encode(piece.cube)};
      pass([&](const Place& other) { return other < place; });
      while (before != work.pieces.end() && before->place() == place) ++before;
      file.piece({work.label, piece.code}, piece.cube, piece.inside, piece.leaving);
    });
    pass([](const Place&) { return true; });
  }

  Hash128 key(std::uint64_t unit, const std::vector<LabelWork>& works) {
    KeyHasher key = begin_key(unit);
    for (const LabelWork& work : works) {
      key.integer(static_cast<std::int64_t>(work.label));
      for (const BoxReads& reads : work.boxes) reads.add_hashes(key);
      for (const OwnPiece& own : work.pieces) {
        const auto artifact = meshes_.open(own.artifact);
        key.integer(static_cast<std::int64_t>(own.record.cube));
        for (const CubePart part : {CubePart::inside, CubePart::leaving})
          key.hash(artifact->part_hash(own.piece, part));
      }
    }
    return key.finish();
  }

  // What is at home in the unit's pieces afterwards: what was, and what has come over the border.
  static PartCounts counts_after(const LabelWork& work) {
    constexpr std::uint64_t more = 1 << 12;
    PartCounts after;
    for (const OwnPiece& own : work.pieces) {
      after += own.record.inside;
      after += own.record.leaving;
    }
    const auto grown = [](std::uint64_t count) { return count + count / 8 + more; };
    PartCounts all{grown(after.vertices), grown(after.triangles), grown(after.samples), 0};
    for (const BoxReads& reads : work.boxes)
      all.samples += reads.all().vertices;  // that go or move
    if (after.sided > 0) all.sided = all.triangles;
    return all;
  }

  static std::uint64_t bytes_of(const LabelWork& work) {
    std::uint64_t box_bytes = 0, largest_part = 0;
    for (const BoxReads& reads : work.boxes) {
      PartCounts own = reads.all();
      own.samples += own.vertices;  // that go or move
      box_bytes = std::max({box_bytes, reading_bytes(reads.all(), reads.largest_part_bytes()),
                            refining_bytes(reads.all(), own)});
    }
    for (const OwnPiece& own : work.pieces)
      largest_part =
          std::max({largest_part, part_bytes(own.record.inside), part_bytes(own.record.leaving)});
    const PartCounts after = counts_after(work);
    return gather_bytes(after.vertices, after.triangles, after.samples, after.sided) +
           std::max({box_bytes, largest_part,
                     piece_bytes(after.vertices, after.triangles, after.sided)});
  }

  MendPlan plan_;
  CubeLattice blocks_;
};

}  // namespace

std::unique_ptr<StageWork> mend_stage(const RefineInputs& inputs) {
  return std::make_unique<MendStage>(inputs);
}

}  // namespace voxweld
