#include "pipeline/refine/mend_stage.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "pipeline/refine/box_reads.h"
#include "pipeline/refine/mend_plan.h"
#include "pipeline/refine/range_stage.h"
#include "stages/refine/box_refiner.h"
#include "stages/refine/mend_box.h"
#include "stages/refine/mesh_part.h"
#include "stages/refine/retile.h"
#include "storage/support/parallel.h"

namespace voxweld {
namespace {

using Place = std::pair<std::uint64_t, std::uint64_t>;  // of a cube: code and Morton number

// A cube of the unit that boxes reach into.
struct OwnCube {
  std::vector<LatticeBox> boxes;
  std::uint64_t before = 0;   // triangles at home there
  std::uint64_t removed = 0;  // of these, in the boxes
  std::uint64_t added = 0;    // in their place
};

struct MendedBox {
  const BoxReads* reads = nullptr;
  RefineMesh before, after;
  RefineCounts counts;
};

// Mends boxes side by side where threads are idle: several at a time, as long as they are small together.
class BoxesAtOnce {
 public:
  static constexpr std::uint64_t most_bytes = 4 << 20;
  using Take = std::function<void(const MendedBox&)>;

  // take: each box, in the order of add(). Both outlive this.
  BoxesAtOnce(const RefineParameters& parameters, const Take& take)
      : parameters_(parameters), take_(take) {}

  // bytes: what it takes to mend it.
  void add(const BoxReads& reads, RefineMesh mesh, std::uint64_t bytes) {
    if (bytes_ + bytes > most_bytes) finish();
    boxes_.push_back({&reads, std::move(mesh), {}, {}});
    bytes_ += bytes;
  }
  void finish() {
    for_each_index(boxes_.size(), [&](std::size_t i) {
      MendedBox& box = boxes_[i];
      box.after = mend_box(box.before, box.reads->box().box, parameters_, box.counts);
    });
    for (const MendedBox& box : boxes_) take_(box);
    boxes_.clear();
    bytes_ = 0;
  }

 private:
  const RefineParameters& parameters_;
  const Take& take_;
  std::vector<MendedBox> boxes_;
  std::uint64_t bytes_ = 0;
};

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
      const MendPlan::Boxes found = plan_->boxes(unit);
      return CubeMeshArtifact(path).key() == key(unit, works(found.boxes, unit), found.beside);
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
    MendPlan::Boxes found = plan_->boxes(unit.key);
    std::vector<LabelWork> all = limited_works(found.boxes, unit.key);
    CubeMeshWriter file(path_of(unit.key), key(unit.key, all, found.beside));
    Result result;
    for (LabelWork& work : all) mend(unit.key, work, worker, file, result);
    result.intersecting.insert(result.intersecting.end(), found.beside.begin(), found.beside.end());
    file.finish({as_record(result.counts), result.blocks, result.changes, result.intersecting});
  }

 private:
  // Of one label the boxes that reach into the unit's cubes, these cubes, and the pieces there.
  struct LabelWork {
    Material label = 0;
    std::vector<BoxReads> boxes;
    std::map<Place, OwnCube> cubes;
    std::vector<PieceRead> pieces;
    PartCounts listed;            // in the pieces, also what patches took out of them
    std::uint64_t largest = 0;    // bytes of a part, as it is read
    std::uint64_t triangles = 0;  // that are there
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
  Place place_of(Index3 cube) const { return {cubes_.code(cube), morton_encode(cube)}; }

  std::vector<LabelWork> works(const std::vector<MendBox>& boxes, std::uint64_t unit) {
    std::vector<LabelWork> works;
    for (const MendBox& box : boxes) {
      if (works.empty() || works.back().label != box.label)
        works.push_back({box.label, {}, {}, {}, {}, 0, 0});
      works.back().boxes.emplace_back(meshes_, cubes_, box);
      each_index({cubes_.cube_of(box.box.lo), cubes_.cube_of(box.box.hi) + splat(1)},
                 [&](Index3 cube) {
                   if (range_of(unit).contains(cubes_.code(cube)))
                     works.back().cubes[place_of(cube)].boxes.push_back(box.box);
                 });
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
    const CubeKey begin{work.label, range_of(unit).begin}, end{work.label, range_of(unit).end};
    meshes_.spans().each(begin, end, [&](std::size_t i) {
      each_piece_of(*meshes_.open(i), begin, end, [&](std::size_t p, const CubePieceRecord& piece) {
        const auto cube = work.cubes.find({piece.code, piece.cube});
        if (cube == work.cubes.end()) return;
        const std::uint64_t triangles = piece.inside.triangles + piece.leaving.triangles;
        cube->second.before += triangles - piece.removed;
        work.triangles += triangles - piece.removed;
        work.pieces.push_back({i, p, true});
        for (const PartCounts& part : {piece.inside, piece.leaving}) {
          work.listed += part;
          work.largest = std::max(work.largest, part_bytes(part));
        }
      });
    });
  }

  static std::vector<LatticeBox> boxes_of(const LabelWork& work) {
    std::vector<LatticeBox> boxes;
    boxes.reserve(work.boxes.size());
    for (const BoxReads& reads : work.boxes) boxes.push_back(reads.box().box);
    return boxes;
  }

  static std::vector<PartOfPiece> own_parts(const LabelWork& work) {
    std::vector<PartOfPiece> parts;
    for (const PieceRead& own : work.pieces)
      for (const CubePart part : {CubePart::inside, CubePart::leaving})
        parts.push_back({own.artifact, own.piece, part});
    return parts;
  }

  void mend(std::uint64_t unit, LabelWork& work, const WorkerContext& worker, CubeMeshWriter& file,
            Result& result) {
    MeshGather gather;
    const PartCounts most = counts_after(work);
    gather.reserve(most.vertices, most.triangles, most.samples, most.sided);
    std::optional<HeldParts> held(std::in_place, meshes_, boxes_of(work));
    for (const PartOfPiece& part : own_parts(work)) {
      worker.check_interrupt();
      held->keep(part);
    }
    std::uint64_t lost = 0;
    std::map<std::uint64_t, std::uint64_t> more;  // triangles of blocks, modulo 2^64
    // f(cube) where the triangle is at home in a cube of the unit.
    const auto if_own = [&](const RefineMesh& mesh, std::size_t t, auto&& f) {
      const Place place = place_of(home_of(mesh, t, cubes_));
      if (range_of(unit).contains(place.first)) f(work.cubes.at(place));
    };
    const BoxesAtOnce::Take take = [&](const MendedBox& box) {
      for (std::size_t t = 0; t < box.before.triangles.size(); ++t)
        if (lies_in(box.before, t, box.reads->box().box))
          if_own(box.before, t, [&](OwnCube& cube) {
            ++cube.removed;
            --more[block_code(box.before, t, blocks_)];
          });
      // Others do the same box where it reaches into theirs, and take what is at home there.
      gather.add(box.after, [&](std::size_t t) {
        bool takes = false;
        if_own(box.after, t, [&](OwnCube& cube) {
          takes = true;
          ++cube.added;
          ++more[block_code(box.after, t, blocks_)];
        });
        return takes;
      });
      const CubeKey owner = box.reads->box().owner;
      if (owner < begin_of(unit) || !(owner < end_of(unit))) return;
      result.counts.add(box.counts);
      lost += box.counts.collapses;  // each took a vertex
    };
    BoxesAtOnce boxes(job_.parameters, take);
    for (const BoxReads& reads : work.boxes) {
      RefineMesh mesh = reads.read(*held, [&] { worker.check_interrupt(); });
      const std::uint64_t bytes = mending_bytes(counts_of(mesh));
      boxes.add(reads, std::move(mesh), bytes);
    }
    boxes.finish();
    held.reset();
    if (lost > 0) result.changes.push_back({work.label, lost});
    for (const auto& [code, triangles] : more)
      if (triangles != 0) result.blocks.push_back({work.label, code, triangles});
    const RefineMesh after = gather.take();
    for (const std::uint32_t t : after.intersecting)
      if_own(after, t, [&](const OwnCube& cube) {
        result.intersecting.push_back(
            {work.label, after.box(t), cube.before - cube.removed + cube.added});
      });
    write_pieces(work, after, file);
  }

  // Of the cubes in whose boxes there was a triangle or is one.
  void write_pieces(const LabelWork& work, const RefineMesh& mesh, CubeMeshWriter& file) const {
    auto next = work.cubes.begin();
    const auto write = [&](const RefineMesh& inside, const RefineMesh& leaving) {
      const auto& [place, cube] = *next++;
      file.piece({work.label, place.first}, morton_decode(place.second), inside, leaving,
                 {cube.boxes, cube.removed});
    };
    const auto pass_to = [&](auto end) {
      while (next != end)
        if (next->second.removed > 0)
          write({}, {});
        else
          ++next;
    };
    each_piece(mesh, cubes_, [&](const CubePiece& piece) {
      pass_to(work.cubes.find({piece.code, morton_encode(piece.cube)}));
      write(piece.inside, piece.leaving);
    });
    pass_to(work.cubes.end());
  }

  Hash128 key(std::uint64_t unit, const std::vector<LabelWork>& works,
              const std::vector<IntersectionRecord>& beside) {
    KeyHasher key = begin_key(unit);
    key.bytes(as_section(beside));
    for (const LabelWork& work : works) {
      key.integer(static_cast<std::int64_t>(work.label));
      for (const BoxReads& reads : work.boxes) reads.add_hashes(key);
      for (const auto& [place, cube] : work.cubes)
        key.integer(static_cast<std::int64_t>(cube.before));
    }
    return key.finish();
  }

  // Of what the pieces list as much as there are triangles, and somewhat more.
  static PartCounts counts_before(const LabelWork& work) {
    const double part = work.listed.triangles == 0 ? 0.0
                                                   : static_cast<double>(work.triangles) /
                                                         static_cast<double>(work.listed.triangles);
    const auto there = [&](std::uint64_t listed) {
      constexpr std::uint64_t more = 1 << 12;
      const auto count = static_cast<std::uint64_t>(part * static_cast<double>(listed));
      return count + count / 8 + more;
    };
    const PartCounts& listed = work.listed;
    return {there(listed.vertices), there(listed.triangles), there(listed.samples),
            listed.sided > 0 ? there(listed.triangles) : 0};
  }

  // What is at home in the boxes afterwards, at most: what was in their cubes, and what has come over
  // the border.
  static PartCounts counts_after(const LabelWork& work) {
    PartCounts all = counts_before(work);
    for (const BoxReads& reads : work.boxes)
      all.samples += reads.all().vertices;  // that go or move
    return all;
  }

  static std::uint64_t mending_bytes(const PartCounts& all) {
    PartCounts own = all;
    own.samples += own.vertices;  // that go or move
    return refining_bytes(all, own);
  }

  // Of the parts of others' pieces, as far as they are held.
  std::uint64_t others_bytes(const LabelWork& work) {
    const std::vector<PartOfPiece> own = own_parts(work);
    std::set<PartOfPiece> seen(own.begin(), own.end());
    std::uint64_t bytes = 0;
    for (const BoxReads& reads : work.boxes)
      for (const PartOfPiece& part : reads.parts()) {
        if (bytes >= HeldParts::most_others_bytes) return HeldParts::most_others_bytes;
        if (!seen.insert(part).second) continue;
        const CubePieceRecord& piece = meshes_.open(part.artifact)->pieces()[part.piece];
        bytes += HeldParts::bytes_of(part.part == CubePart::inside ? piece.inside : piece.leaving);
      }
    return std::min(bytes, HeldParts::most_others_bytes);
  }

  std::uint64_t bytes_of(const LabelWork& work) {
    std::uint64_t box_bytes = 0;
    for (const BoxReads& reads : work.boxes)
      box_bytes = std::max({box_bytes, reading_bytes(reads.all(), reads.largest_part_bytes()),
                            mending_bytes(reads.all())});
    // One is read while others wait.
    if (work.boxes.size() > 1) box_bytes += BoxesAtOnce::most_bytes;
    box_bytes += others_bytes(work);
    const PartCounts before = counts_before(work);
    const std::uint64_t held =
        HeldParts::bytes_of(before) + 2 * work.pieces.size() * HeldPart::bytes(0);
    const PartCounts after = counts_after(work);
    return gather_bytes(after.vertices, after.triangles, after.samples, after.sided) +
           std::max({held + work.largest, held + box_bytes,
                     piece_bytes(after.vertices, after.triangles, after.sided)});
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
