#include "pipeline/run/brick_sample.h"

#include <ctime>

#include "pipeline/build/contour_parameters.h"
#include "pipeline/build/local_edits.h"
#include "stages/build/build_brick.h"
#include "stages/build/label_bricks.h"
#include "stages/ingest/statistics.h"
#include "stages/ingest/threshold.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Where the samples can be read from now.
std::shared_ptr<const SampleSource> readable(const RunContext& context, const Jobs& jobs) {
  const IngestJob& job = jobs.ingest();
  if (job.mesh && !bins_are_current(*job.mesh)) return nullptr;
  if (job.input && job.input->info().access == Access::box) return job.input;
  if (job.copy && ingest_stage(context.config, job)->look(context.selection).missing.empty())
    return ingested_volume(context.config, job).source;
  return nullptr;
}

std::vector<Index3> spread(Index3 bricks, std::int64_t most) {
  Index3 count{1, 1, 1};
  // The axis with the widest gaps gets one more, while there is room.
  for (;;) {
    int widest = 0;
    for (int a = 1; a < 3; ++a)
      if (bricks[a] * count[widest] > bricks[widest] * count[a]) widest = a;
    Index3 more = count;
    ++more[widest];
    if (more[widest] > bricks[widest] || more.x * more.y * more.z > most) break;
    count = more;
  }
  std::vector<Index3> chosen;
  for (std::int64_t z = 0; z < count.z; ++z)
    for (std::int64_t y = 0; y < count.y; ++y)
      for (std::int64_t x = 0; x < count.x; ++x)
        chosen.push_back({(2 * x + 1) * bricks.x / (2 * count.x),
                          (2 * y + 1) * bricks.y / (2 * count.y),
                          (2 * z + 1) * bricks.z / (2 * count.z)});
  return chosen;
}

class Sampler {
 public:
  Sampler(const BrickGrid& grid, const SampleSource& source, const ContourParameters& parameters)
      : grid_(grid), source_(source), parameters_(parameters) {}

  // Reads the brick's samples; empty where it is all ring.
  HaloBlock read(Index3 brick) {
    const BrickPlace place = place_of(brick);
    const Box3 box = intersect(halo_samples(place, parameters_), Box3{{}, grid_.size()});
    const VolumeInfo& info = source_.info();
    samples_.resize(box.empty() ? 0
                                : static_cast<std::size_t>(box.count()) * sample_bytes(info.type));
    if (!box.empty()) source_.read(box, samples_.data());
    const Index3 extent = box.size();
    return {info.type, grid_.size(), box, samples_.data(), extent.x, extent.x * extent.y};
  }
  std::span<const std::byte> samples() const { return samples_; }

  void build(Index3 brick, LocalEdits& edits, BrickSample& sums) {
    const HaloBlock block = read(brick);
    const ContourParameters& parameters = edits.around(sign_samples(grid_, brick));
    const double before = thread_seconds();
    const std::uint64_t vertices = sums.vertices;
    if (parameters.labels.mode == LabelMode::each) {
      labels_.fill(block, parameters);
      labels_.each(place_of(brick), parameters,
                   [&](Material, const BrickOctree& octree) { add(octree, sums); });
    } else {
      build_brick(block, place_of(brick), parameters, scratch_, octree_);
      add(octree_, sums);
    }
    sums.cpu_s += thread_seconds() - before;
    ++sums.bricks;
    if (sums.vertices > vertices) ++sums.active;
  }

 private:
  static void add(const BrickOctree& octree, BrickSample& sums) {
    if (octree.counts.active_cells == 0) return;
    sums.vertices += octree.vertices.size();
    sums.polygons += octree.polygons.size();
    sums.octree_bytes +=
        octree.vertices.size() * sizeof(LeafVertex) + octree.polygons.size() * sizeof(PolygonRefs) +
        octree.blocks.size() * sizeof(BlockCount) + octree.ghost.cells.size() * sizeof(GhostCell) +
        octree.ghost.vertices.size() * sizeof(GhostVertex);
  }
  BrickPlace place_of(Index3 brick) const { return place_of_brick(grid_, brick); }

  const BrickGrid& grid_;
  const SampleSource& source_;
  const ContourParameters parameters_;  // what decides the halo
  std::vector<std::byte> samples_;
  BrickScratch scratch_;
  BrickOctree octree_;
  LabelBricks labels_;
};

}  // namespace

Index3 sampled_bricks(const BrickGrid& grid) {
  const std::int64_t side = std::int64_t{1} << grid.brick_level();
  Index3 bricks;
  for (int a = 0; a < 3; ++a) bricks[a] = (grid.size()[a] + side - 1) / side;
  return bricks;
}

std::optional<BrickSample> sample_bricks(const RunContext& context, const Jobs& jobs,
                                         std::int64_t most) {
  const auto source = readable(context, jobs);
  if (source == nullptr) return std::nullopt;
  const VolumeInfo& info = source->info();
  const BrickGrid grid = brick_grid(context.config, info.geometry);
  const std::vector<Index3> chosen = spread(sampled_bricks(grid), most);
  ContourParameters halo;
  halo.surface.label = context.config.surface.label;
  halo.labels.mode = context.config.labels.mode;
  Sampler sampler(grid, *source, halo);
  Config config = context.config;
  if (!config.surface.isovalue) {
    HistogramStatistics statistics(info.type);
    for (const Index3& brick : chosen) {
      sampler.read(brick);
      if (!sampler.samples().empty()) statistics.add(sampler.samples());
    }
    const auto suggestion =
        suggest_isovalue(statistics.take(), info.scale, config.surface.isovalue_rule);
    if (!suggestion) return std::nullopt;
    config.surface.isovalue = suggestion->threshold.value;
  }
  BrickSample sums;
  if (config.input.has_samples()) sums.isovalue = config.surface.isovalue;
  const ContourParameters parameters =
      contour_parameters(config, info, jobs.ingest().solid, jobs.chosen_labels(config));
  LocalEdits edits(parameters);
  for (const Index3& brick : chosen) sampler.build(brick, edits, sums);
  return sums;
}

}  // namespace voxweld
