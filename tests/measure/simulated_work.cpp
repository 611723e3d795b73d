#include "tests/measure/simulated_work.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>

#include "pipeline/build/build_stage.h"
#include "storage/support/file_io.h"
#include "tests/measure/stage_looks.h"

namespace voxweld {
namespace {

constexpr std::size_t ingest = 0, build = 1, merge_number = 2, stitch = 3, encode = 4;
constexpr std::int64_t shard_samples = 256;

MeasuredUnit unit_of(const nlohmann::json& entry) {
  MeasuredUnit unit;
  unit.cpu_s = entry.at("cpu_s");
  unit.read_bytes = entry.at("read_bytes");
  unit.written_bytes = entry.at("written_bytes");
  unit.files = entry.at("files");
  unit.peak_bytes = entry.at("peak_bytes");
  unit.trips = entry.at("trips").is_null() ? -1.0 : entry.at("trips").get<double>();
  if (entry.contains("weight") && !entry.at("weight").is_null()) unit.weight = entry.at("weight");
  return unit;
}

// The trips of some were counted: the others get their mean.
void fill_trips(std::vector<MeasuredUnit>& units) {
  double sum = 0, count = 0;
  for (const MeasuredUnit& unit : units)
    if (unit.trips >= 0) sum += unit.trips, ++count;
  for (MeasuredUnit& unit : units)
    if (unit.trips < 0) unit.trips = count > 0 ? sum / count : 0;
}

MeasuredUnit beyond(const MeasuredUnit& unit, const MeasuredUnit& empty) {
  const auto rest = [](double whole, double part) { return std::max(0.0, whole - part); };
  MeasuredUnit left = unit;
  left.cpu_s = std::max(5e-4, unit.cpu_s - empty.cpu_s);  // half of what the clock shows
  left.read_bytes = rest(unit.read_bytes, empty.read_bytes);
  left.written_bytes = rest(unit.written_bytes, empty.written_bytes);
  left.trips = rest(unit.trips, empty.trips);
  return left;
}

// What a task takes before its first unit, in a volume of that many shards: a straight line through
// the smallest and the largest volume measured.
MeasuredUnit task_cost(const WorkMix& mix, std::size_t stage, double shards) {
  const auto by_shards = [](const WorkMix::Source& a, const WorkMix::Source& b) {
    return a.costs.shards < b.costs.shards;
  };
  const auto [low, high] = std::minmax_element(mix.sources.begin(), mix.sources.end(), by_shards);
  const MeasuredUnit &a = low->costs.empty_task[stage], &b = high->costs.empty_task[stage];
  const double apart = high->costs.shards - low->costs.shards;
  const auto line = [&](double at_low, double at_high) {
    const double slope = apart > 0 ? std::max(0.0, at_high - at_low) / apart : 0;
    return at_low + slope * (shards - low->costs.shards);
  };
  MeasuredUnit task = a;
  task.cpu_s = line(a.cpu_s, b.cpu_s);
  task.read_bytes = line(a.read_bytes, b.read_bytes);
  task.written_bytes = line(a.written_bytes, b.written_bytes);
  task.trips = std::max(a.trips, 0.0);
  return task;
}

// The cheapest shard measured stands for those without a surface.
MeasuredUnit cheapest(const WorkMix& mix, std::size_t stage) {
  MeasuredUnit found;
  found.cpu_s = 1e300;
  for (const WorkMix::Source& source : mix.sources)
    for (const MeasuredUnit& unit : source.costs.units[stage])
      if (unit.cpu_s < found.cpu_s) found = unit;
  return found;
}

class Drawing {
 public:
  Drawing(const WorkMix& mix, std::int64_t samples) : mix_(mix), random_(mix.seed) {
    const BrickGrid grid({samples, samples, samples}, 6, 4);
    std::vector<std::uint64_t> numbers(grid.all_shards().size());
    std::iota(numbers.begin(), numbers.end(), std::uint64_t{0});
    work_.shards = static_cast<double>(numbers.size());
    work_.stages[build].units = shard_units(grid, numbers);
    for (const std::uint64_t number : numbers)
      work_.stages[ingest].units.push_back(
          {number, {}, static_cast<double>(shard_samples * shard_samples * shard_samples), 0});
    for (std::size_t s = 0; s < stages_simulated; ++s)
      work_.stages[s].task = task_cost(mix, s, work_.shards);
    owed_.resize(mix.sources.size());
  }

  SimulatedWork draw() {
    const std::size_t shards = work_.stages[build].units.size();
    for (std::size_t at = 0; at < shards; at += mix_.patch)
      draw_patch(std::min(mix_.patch, shards - at));
    work_.tiles = static_cast<double>(work_.stages[stitch].units.size());
    draw_merge();
    for (MeasuredUnit& unit : work_.stages[ingest].costs) {
      unit.read_bytes = RowReads::rows * mix_.rows.bytes;
      unit.trips += RowReads::rows * mix_.rows.trips;
    }
    return std::move(work_);
  }

 private:
  const MeasuredUnit& any_of(const std::vector<MeasuredUnit>& units) {
    return units[std::uniform_int_distribution<std::size_t>(0, units.size() - 1)(random_)];
  }

  void draw_patch(std::size_t shards) {
    std::vector<double> shares = {mix_.empty_share};
    for (const WorkMix::Source& source : mix_.sources) shares.push_back(source.share);
    const std::size_t kind =
        std::discrete_distribution<std::size_t>(shares.begin(), shares.end())(random_);
    if (kind == 0) {
      for (const std::size_t stage : {ingest, build})
        work_.stages[stage].costs.insert(work_.stages[stage].costs.end(), shards,
                                         cheapest(mix_, stage));
      return;
    }
    const MeasuredCosts& costs = mix_.sources[kind - 1].costs;
    for (const std::size_t stage : {ingest, build})
      for (std::size_t i = 0; i < shards; ++i)
        work_.stages[stage].costs.push_back(any_of(costs.units[stage]));
    work_.vertices += costs.vertices * static_cast<double>(shards) / costs.shards;
    draw_tiles(costs, owed_[kind - 1] += costs.tiles * static_cast<double>(shards) / costs.shards);
  }

  // A tile is the same in both stages.
  void draw_tiles(const MeasuredCosts& costs, double& owed) {
    std::uniform_int_distribution<std::size_t> one(0, costs.units[stitch].size() - 1);
    for (; owed >= 1; --owed) {
      const std::size_t tile = one(random_);
      for (const std::size_t stage : {stitch, encode}) {
        SimulatedUnits& work = work_.stages[stage];
        const MeasuredUnit& unit = costs.units[stage][tile];
        work.units.push_back({work.units.size(), {}, unit.weight, 0});
        work.costs.push_back(unit);
      }
    }
  }

  // Its own time goes with the shards; round trips are counted where its looks are.
  void draw_merge() {
    MeasuredUnit unit;
    double shards = 0;
    for (const WorkMix::Source& source : mix_.sources)
      if (source.share > 0 && !source.costs.units[merge_number].empty()) {
        unit.cpu_s += source.costs.units[merge_number].front().cpu_s;
        unit.read_bytes += source.costs.units[merge_number].front().read_bytes;
        unit.written_bytes += source.costs.units[merge_number].front().written_bytes;
        shards += source.costs.shards;
      }
    const double scale = shards > 0 ? work_.shards / shards : 0;
    unit.cpu_s *= scale, unit.read_bytes *= scale, unit.written_bytes *= scale;
    unit.files = 1;
    work_.stages[merge_number].units.push_back({0, {}, 1, 0});
    work_.stages[merge_number].costs.push_back(unit);
  }

  const WorkMix& mix_;
  std::mt19937_64 random_;
  std::vector<double> owed_;  // tiles, per source
  SimulatedWork work_;
};

}  // namespace

MeasuredCosts read_costs(const std::string& path) {
  const auto bytes = read_whole_file(path);
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  const auto document = nlohmann::json::parse(text, text + bytes.size());
  MeasuredCosts costs;
  costs.name = document.at("phantom");
  costs.shards = document.at("shards");
  costs.tiles = document.at("tiles");
  costs.vertices = document.at("vertices");
  for (std::size_t s = 0; s < stages_simulated; ++s) {
    const std::string stage(simulated_stages[s]);
    const auto& empties = document.at("empty_task");
    if (empties.contains(stage)) costs.empty_task[s] = unit_of(empties.at(stage));
    if (!document.at("stages").contains(stage)) continue;
    for (const auto& entry : document.at("stages").at(stage))
      costs.units[s].push_back(unit_of(entry));
    fill_trips(costs.units[s]);
    for (MeasuredUnit& unit : costs.units[s])
      unit = beyond(unit, costs.empty_task[s == merge_number ? build : s]);
  }
  return costs;
}

SimulatedWork draw_work(const WorkMix& mix, std::int64_t samples) {
  return Drawing(mix, samples).draw();
}

}  // namespace voxweld
