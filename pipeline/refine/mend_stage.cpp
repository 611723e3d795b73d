#include "pipeline/refine/mend_stage.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "pipeline/refine/box_reads.h"
#include "pipeline/refine/mend_plan.h"
#include "pipeline/refine/range_stage.h"
#include "pipeline/stage/cube_mesh.h"
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

bool lies_in(const LatticeBox& inner, const LatticeBox& box) {
  return box.contains(inner.lo) && box.contains(inner.hi);
}

bool lies_in_any(const LatticeBox& inner, const std::vector<LatticeBox>& boxes) {
  return std::ranges::any_of(boxes, [&](const LatticeBox& box) { return lies_in(inner, box); });
}

class MendStage final : public RangeStage {
 public:
  explicit MendStage(const RefineInputs& inputs)
      : RangeStage(inputs), blocks_(tile_blocks(job_.frame)) {
    if (inputs.places) listed_.emplace(std::vector<MeshLayer>{*inputs.places});
    plan_.emplace(MendPlan::Inputs{places(), units_, job_.frame, job_.room, cubes_});
  }

  bool done(std::uint64_t unit) override {
    const std::filesystem::path path = path_of(unit);
    return is_current(path, [&] {
      return CubeMeshArtifact(path).key() ==
             key(unit, works(plan_->boxes(unit).boxes, unit), records(unit));
    });
  }
  StageMemory memory(std::span<const std::uint64_t> numbers) override {
    StageMemory memory = RangeStage::memory(numbers);
    memory.base_bytes += plan_->bytes();
    memory.per_unit_bytes = std::max(memory.per_unit_bytes, plan_->planning_bytes());
    return memory;
  }
  std::uint64_t bytes(std::uint64_t unit) override {
    const MendPlan::Boxes found = plan_->boxes(unit);
    std::uint64_t most = found.places * MendPlan::bytes_of_place;
    for (const LabelWork& work : limited_works(found.boxes, unit))
      most = std::max(most, bytes_of(work));
    return most;
  }
  void run(const Unit& unit, WorkerContext& worker) override {
    const std::vector<LabelWork> all = limited_works(plan_->boxes(unit.key).boxes, unit.key);
    const std::vector<IntersectionRecord> listed = records(unit.key);
    CubeMeshWriter file(path_of(unit.key), key(unit.key, all, listed));
    Result result;
    for (const LabelWork& work : all) mend(unit.key, work, worker, file, result);
    add_beside(all, listed, result);
    file.finish({as_record(result.counts), result.blocks, result.changes, result.intersecting});
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
    std::vector<IntersectionRecord> intersecting;
  };

  CubeMeshes& places() { return listed_ ? *listed_ : meshes_; }

  CubeKey begin_of(std::uint64_t unit) const {
    return {units_[unit].first_label, range_of(unit).begin};
  }
  CubeKey end_of(std::uint64_t unit) const {
    return {units_[unit].end_label - 1, range_of(unit).end};
  }

  std::vector<LabelWork> works(const std::vector<MendBox>& boxes, std::uint64_t unit) {
    std::vector<LabelWork> works;
    for (const MendBox& box : boxes) {
      if (works.empty() || works.back().label != box.label) works.push_back({box.label, {}, {}});
      works.back().boxes.emplace_back(meshes_, cubes_, box);
    }
    for (LabelWork& work : works) find_pieces(unit, work);
    return works;
  }

  // For memory; a key does not ask how much there is.
  std::vector<LabelWork> limited_works(const std::vector<MendBox>& boxes, std::uint64_t unit) {
    std::vector<LabelWork> all = works(boxes, unit);
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
        if (meshes_.is_replaced(i, piece)) return;
        if (std::ranges::any_of(near, [&](const Box3& box) { return box.contains(cube); }))
          work.pieces.push_back({i, p, piece});
      });
    });
    std::ranges::stable_sort(work.pieces, {}, &OwnPiece::place);
  }

  BoxReads::Held read_pieces(const LabelWork& work, const WorkerContext& worker) {
    BoxReads::Held held;
    for (const OwnPiece& own : work.pieces) {
      worker.check_interrupt();
      const auto artifact = meshes_.open(own.artifact);
      for (const CubePart part : {CubePart::inside, CubePart::leaving})
        held.try_emplace({own.artifact, own.piece, part}, artifact->read(own.piece, part));
    }
    return held;
  }

  void mend(std::uint64_t unit, const LabelWork& work, const WorkerContext& worker,
            CubeMeshWriter& file, Result& result) {
    MeshGather gather;
    const PartCounts most = counts_after(work);
    gather.reserve(most.vertices, most.triangles, most.samples, most.sided);
    BoxReads::Held held = read_pieces(work, worker);
    std::uint64_t lost = 0;
    // Triangles of blocks, modulo 2^64. Those beside all boxes stay.
    std::map<std::uint64_t, std::uint64_t> more;
    for (const BoxReads& reads : work.boxes) {
      RefineCounts counts;
      const RefineMesh mended = mend_box(reads.read(held, [&] { worker.check_interrupt(); }),
                                         reads.box().box, job_.parameters, counts);
      // Others do the same box where it reaches into theirs, and take what is at home there.
      gather.add(mended, [&](std::size_t t) {
        const bool takes = range_of(unit).contains(cubes_.code(home_of(mended, t, cubes_)));
        if (takes) ++more[block_code(mended, t, blocks_)];
        return takes;
      });
      const CubeKey owner = reads.box().owner;
      if (owner < begin_of(unit) || !(owner < end_of(unit))) continue;
      result.counts.add(counts);
      lost += counts.collapses;  // each took a vertex
    }
    if (lost > 0) result.changes.push_back({work.label, lost});
    for (const auto& entry : held) {
      const HeldPart& before = entry.second;
      const std::vector<LatticeBox> near = boxes_near(work, before);
      gather.add(before.mesh, [&](std::size_t t) {
        const bool stays = !lies_in_any(before.boxes[t], near);
        if (!stays) --more[block_code(before.mesh, t, blocks_)];
        return stays;
      });
    }
    held.clear();
    const RefineMesh after = gather.take();
    for (const auto& [code, triangles] : more)
      if (triangles != 0) result.blocks.push_back({work.label, code, triangles});
    add_intersections(work.label, after, after.intersecting, cubes_, result.intersecting);
    write_pieces(work, after, file);
  }

  static std::vector<LatticeBox> boxes_near(const LabelWork& work, const HeldPart& part) {
    std::vector<LatticeBox> near;
    if (part.boxes.empty()) return near;
    LatticeBox all = part.boxes.front();
    for (const LatticeBox& box : part.boxes) all.extend(box);
    for (const BoxReads& reads : work.boxes)
      if (reads.box().box.meets(all)) near.push_back(reads.box().box);
    return near;
  }

  // What was listed and may lie in no box. Where all boxes are planned at once each place meets one, so
  // its piece is written again and says it; but for patches, whose places their unit lists.
  std::vector<IntersectionRecord> records(std::uint64_t unit) {
    if (!plan_->holds_all()) return plan_->records(unit);
    return listed_ ? listed_->open(unit)->intersecting() : std::vector<IntersectionRecord>{};
  }
  // Those that do. Of pieces of the unit that were written again it is known already.
  static void add_beside(const std::vector<LabelWork>& works,
                         const std::vector<IntersectionRecord>& listed, Result& result) {
    const auto place = [](const IntersectionRecord& record) {
      return std::tuple(record.label, record.box.lo, record.box.hi);
    };
    std::set<std::tuple<Material, LatticePoint, LatticePoint>> known;
    for (const IntersectionRecord& record : result.intersecting) known.insert(place(record));
    for (const IntersectionRecord& record : listed)
      if (!known.contains(place(record)) && std::ranges::none_of(works, [&](const LabelWork& work) {
            return work.label == record.label &&
                   std::ranges::any_of(work.boxes, [&](const BoxReads& reads) {
                     return lies_in(record.box, reads.box().box);
                   });
          }))
        result.intersecting.push_back(record);
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

  Hash128 key(std::uint64_t unit, const std::vector<LabelWork>& works,
              const std::vector<IntersectionRecord>& listed) {
    KeyHasher key = begin_key(unit);
    key.bytes(as_section(listed));
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
    std::uint64_t box_bytes = 0, held = 0;
    for (const BoxReads& reads : work.boxes) {
      PartCounts own = reads.all();
      own.samples += own.vertices;  // that go or move
      box_bytes = std::max({box_bytes, reading_bytes(reads.all(), reads.largest_part_bytes()),
                            refining_bytes(reads.all(), own)});
    }
    for (const OwnPiece& own : work.pieces)
      for (const PartCounts& part : {own.record.inside, own.record.leaving})
        held += part_bytes(part) / 2 + part.triangles * sizeof(LatticeBox);
    const PartCounts after = counts_after(work);
    return gather_bytes(after.vertices, after.triangles, after.samples, after.sided) +
           std::max(held + box_bytes, piece_bytes(after.vertices, after.triangles, after.sided));
  }

  std::optional<CubeMeshes> listed_;  // what intersects, where the meshes do not say it
  std::optional<MendPlan> plan_;
  CubeLattice blocks_;
};

}  // namespace

std::unique_ptr<StageWork> mend_stage(const RefineInputs& inputs) {
  return std::make_unique<MendStage>(inputs);
}

}  // namespace voxweld
