// The units of a volume nobody has at hand, drawn from units that were measured.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/executor/executor.h"

namespace voxweld {

struct MeasuredUnit {
  double cpu_s = 0, read_bytes = 0, written_bytes = 0, files = 0;
  double trips = 0;   // to a file system
  double weight = 0;  // stitch and encode; elsewhere it follows from the volume's size
  double peak_bytes = 0;
};

constexpr std::size_t stages_simulated = 5;  // in the order of simulated_stages

// One file that measure_costs.sh wrote.
struct MeasuredCosts {
  std::string name;
  double shards = 0, tiles = 0, vertices = 0;
  std::array<std::vector<MeasuredUnit>, stages_simulated> units;  // beyond an empty task's
  std::array<MeasuredUnit, stages_simulated> empty_task;
};

MeasuredCosts read_costs(const std::string& path);

// How a shard's rows come out of the input, each on its own where they lie apart in the file: what
// a small phantom does not show, whose rows are so short that the gaps are read with them.
struct RowReads {
  double trips = 0;    // of a row
  double bytes = 256;  // read for the 256 samples of it
  static constexpr double rows = 256 * 256;
};

struct WorkMix {
  struct Source {
    MeasuredCosts costs;
    double share = 0;  // of the shards; 0: only for how empty tasks grow with the volume
  };
  std::vector<Source> sources;
  double empty_share = 0;  // of shards without a surface
  // Shards that follow each other in Morton order and are of one source: matter lies together.
  std::size_t patch = 512;
  std::uint64_t seed = 1;
  RowReads rows;
};

struct SimulatedUnits {
  std::vector<Unit> units;          // as the stage itself would list them
  std::vector<MeasuredUnit> costs;  // beside them
  MeasuredUnit task;                // of a task before its first unit
};

struct SimulatedWork {
  std::array<SimulatedUnits, stages_simulated> stages;
  double shards = 0, tiles = 0, vertices = 0;
};

// A volume of that many samples a side at the default brick and shard sizes.
SimulatedWork draw_work(const WorkMix& mix, std::int64_t samples);

}  // namespace voxweld
