#include "pipeline/neuroglancer/folder_check.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <map>
#include <nlohmann/json.hpp>

#include "pipeline/executor/progress.h"
#include "pipeline/neuroglancer/folder_reader.h"
#include "storage/support/error.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

using Point = GridPoint;  // or the bits of three floats
using Edge = std::array<Point, 2>;
using Balance = std::map<Edge, int>;  // how much more often an edge is used from its lower end

// Fragments are looked at so many at a time.
constexpr std::size_t fragments_at_once = 64;

void add_edge(Balance& balance, const Point& a, const Point& b, int times = 1) {
  const auto [at, is_new] = balance.try_emplace(a < b ? Edge{a, b} : Edge{b, a}, 0);
  at->second += a < b ? times : -times;
  if (at->second == 0) balance.erase(at);
}

struct FragmentReport {
  std::uint64_t triangles = 0, flat = 0;
  std::uint8_t octants = 0;
  std::uint64_t across = 0;  // triangles across octants
  double volume6 = 0;
  Balance open;
  std::string problem;  // that it could not be read
};

template <class Corner>
double volume6_of(const std::array<Corner, 3>& p) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k)
    sum +=
        p[0][k] * (p[1][(k + 1) % 3] * p[2][(k + 2) % 3] - p[1][(k + 2) % 3] * p[2][(k + 1) % 3]);
  return sum;
}

template <class Corner>
bool is_flat(const std::array<Corner, 3>& p) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
    if ((p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) != (p[1][v] - p[0][v]) * (p[2][u] - p[0][u]))
      return false;
  }
  return true;
}

// Edges within the fragment cancel here, so that few are left to compare.
FragmentReport look_at(const FragmentMesh& mesh, const FragmentCell& cell, int lod) {
  FragmentReport report;
  report.triangles = mesh.triangles.size();
  std::map<std::array<std::uint32_t, 2>, int> inner;
  const auto on_grid = [&](std::uint32_t v) {
    Point p{};
    for (std::size_t k = 0; k < 3; ++k) p[k] = cell[k] * fragment_range + mesh.positions[v][k];
    return p;
  };
  for (const auto& t : mesh.triangles) {
    FragmentTriangle corners;
    std::array<std::array<double, 3>, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      const Point at = on_grid(t[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        corners[i][k] = static_cast<std::uint16_t>(mesh.positions[t[i]][k]);
        p[i][k] = static_cast<double>(at[k]);
      }
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      inner[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
    report.volume6 += volume6_of(p);
    report.flat += is_flat(p) ? 1 : 0;
    if (lod == 0) continue;
    report.octants = static_cast<std::uint8_t>(report.octants | 1u << octant_of(corners));
    report.across += crosses_octants(corners) ? 1 : 0;
  }
  for (const auto& [edge, times] : inner)
    if (times != 0) add_edge(report.open, on_grid(edge[0]), on_grid(edge[1]), times);
  return report;
}

class FolderCheck {
 public:
  FolderCheck(const std::filesystem::path& folder, const InterruptFlag* interrupt)
      : reader_(folder), interrupt_(interrupt) {}

  FolderReport run() {
    if (reader_.ids().empty()) problem("has no object");
    for (const std::uint64_t id : reader_.ids()) {
      try {
        report_.objects.push_back(reader_.legacy() ? check_legacy(id) : check(id));
      } catch (const FormatError& e) {
        problem(e.what());
      } catch (const StorageError& e) {
        problem(e.what());
      }
    }
    return std::move(report_);
  }

 private:
  void problem(std::string text) { report_.problems.push_back(std::move(text)); }

  ObjectReport check(std::uint64_t id) {
    const ExportedObject object = reader_.object(id);
    check_size(object);
    ObjectReport report{id, {}};
    std::vector<FragmentLevel> levels = object.index.levels;
    std::uint64_t offset = 0;
    for (int lod = 0; lod < static_cast<int>(levels.size()); ++lod)
      report.levels.push_back(
          check_level(object, lod, levels[static_cast<std::size_t>(lod)], offset));
    check_tree(id, levels);
    return report;
  }

  // Or each fragment past the end would be a problem of its own.
  static void check_size(const ExportedObject& object) {
    std::uint64_t bytes = object.offset;
    for (const FragmentLevel& level : object.index.levels)
      for (const FragmentEntry& entry : level.fragments) bytes += entry.bytes;
    const std::uint64_t size = ReadFile(object.data).size();
    if (size < bytes)
      throw FormatError(fmt::format("{}: has {} bytes, and the fragments of object {} end at {}",
                                    object.data.string(), size, object.id, bytes));
  }

  LevelReport check_level(const ExportedObject& object, int lod, FragmentLevel& level,
                          std::uint64_t& offset) {
    LevelReport report;
    Balance open;
    double volume6 = 0;
    std::vector<FragmentEntry>& fragments = level.fragments;
    for (std::size_t first = 0; first < fragments.size(); first += fragments_at_once) {
      if (interrupt_ != nullptr) interrupt_->check();
      const std::size_t count = std::min(fragments_at_once, fragments.size() - first);
      std::vector<std::uint64_t> offsets(count);
      for (std::size_t i = 0; i < count; ++i) {
        offsets[i] = offset;
        offset += fragments[first + i].bytes;
      }
      std::vector<FragmentReport> reports(count);
      tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        const FragmentEntry& entry = fragments[first + i];
        if (entry.bytes != 0) reports[i] = look(object, lod, entry, offsets[i]);
      });
      for (std::size_t i = 0; i < count; ++i) {
        fold(reports[i], object.id, lod, fragments[first + i], report);
        volume6 += reports[i].volume6;
        for (const auto& [edge, times] : reports[i].open) add_edge(open, edge[0], edge[1], times);
      }
    }
    const double side = static_cast<double>(object.index.chunk_shape[0]) *
                        static_cast<double>(std::int64_t{1} << lod) / fragment_range;
    report.volume = volume6 / 6 * side * side * side;
    close(object.id, lod, open, report);
    return report;
  }

  FragmentReport look(const ExportedObject& object, int lod, const FragmentEntry& entry,
                      std::uint64_t offset) const {
    try {
      return look_at(reader_.fragment(object, entry, offset), fragment_cell(entry.code), lod);
    } catch (const FormatError& e) {
      FragmentReport report;
      report.problem = e.what();
      return report;
    }
  }

  void fold(const FragmentReport& fragment, std::uint64_t id, int lod, FragmentEntry& entry,
            LevelReport& report) {
    if (!fragment.problem.empty()) problem(fragment.problem);
    if (fragment.across > 0)
      problem(fmt::format("object {}, level {}: {} triangles of a fragment cross its octants", id,
                          lod, fragment.across));
    entry.octants = fragment.octants;
    report.fragments += entry.bytes != 0 ? 1 : 0;
    report.triangles += fragment.triangles;
    report.flat += fragment.flat;
  }

  void close(std::uint64_t id, int lod, const Balance& open, LevelReport& report) {
    report.open_edges = open.size();
    if (!open.empty() && !reader_.open_border())
      problem(fmt::format("object {}, level {}: {} edges are open", id, lod, open.size()));
  }

  // Adding what is missing must add nothing.
  void check_tree(std::uint64_t id, const std::vector<FragmentLevel>& levels) {
    std::vector<FragmentLevel> all = levels;
    add_empty_fragments(all);
    for (std::size_t lod = 0; lod < levels.size(); ++lod) {
      const auto codes_rise = [](const FragmentEntry& a, const FragmentEntry& b) {
        return a.code >= b.code;
      };
      if (std::ranges::adjacent_find(levels[lod].fragments, codes_rise) !=
          levels[lod].fragments.end())
        problem(fmt::format("object {}, level {}: fragments are not in Z-order", id, lod));
      if (all[lod].fragments.size() != levels[lod].fragments.size())
        problem(fmt::format("object {}, level {}: clients do not find {} fragments", id, lod,
                            all[lod].fragments.size() - levels[lod].fragments.size()));
    }
  }

  ObjectReport check_legacy(std::uint64_t id) {
    LevelReport report;
    Balance open;
    double volume6 = 0;
    for (const std::string& name : reader_.legacy_names(id)) {
      if (interrupt_ != nullptr) interrupt_->check();
      const LegacyMesh mesh = reader_.legacy_fragment(name);
      ++report.fragments;
      report.triangles += mesh.triangles.size();
      for (const auto& t : mesh.triangles) {
        std::array<std::array<double, 3>, 3> p;
        std::array<Point, 3> bits;
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t k = 0; k < 3; ++k) {
            const float x = mesh.positions[t[i]][k];
            p[i][k] = static_cast<double>(x);
            bits[i][k] = std::bit_cast<std::int32_t>(x);
          }
        volume6 += volume6_of(p);
        report.flat += is_flat(p) ? 1 : 0;
        for (std::size_t i = 0; i < 3; ++i) add_edge(open, bits[i], bits[(i + 1) % 3]);
      }
    }
    report.volume = volume6 / 6;
    close(id, 0, open, report);
    return {id, {report}};
  }

  const FolderReader reader_;
  const InterruptFlag* interrupt_;
  FolderReport report_;
};

}  // namespace

FolderReport check_folder(const std::filesystem::path& folder, int threads,
                          const InterruptFlag* interrupt) {
  const tbb::global_control limit(
      tbb::global_control::max_allowed_parallelism,
      static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency()));
  return FolderCheck(folder, interrupt).run();
}

std::string to_text(const FolderReport& report) {
  std::string text = counted(report.objects.size(), "objects") + "\n";
  std::vector<LevelReport> levels;
  for (const ObjectReport& object : report.objects)
    for (std::size_t lod = 0; lod < object.levels.size(); ++lod) {
      if (lod >= levels.size()) levels.emplace_back();
      levels[lod].fragments += object.levels[lod].fragments;
      levels[lod].triangles += object.levels[lod].triangles;
      levels[lod].open_edges += object.levels[lod].open_edges;
      levels[lod].flat += object.levels[lod].flat;
    }
  for (std::size_t lod = 0; lod < levels.size(); ++lod)
    text += fmt::format("level {}: {}, {}, {} without area, {}\n", lod,
                        counted(levels[lod].fragments, "fragments"),
                        counted(levels[lod].triangles, "triangles"), levels[lod].flat,
                        counted(levels[lod].open_edges, "open edges"));
  for (const std::string& problem : report.problems) text += "problem: " + problem + "\n";
  return text + (report.good() ? "good: no problem found\n"
                               : counted(report.problems.size(), "problems") + "\n");
}

std::string to_json_text(const FolderReport& report) {
  nlohmann::ordered_json json;
  json["good"] = report.good();
  json["problems"] = report.problems;
  json["objects"] = nlohmann::ordered_json::array();
  for (const ObjectReport& object : report.objects) {
    nlohmann::ordered_json levels = nlohmann::ordered_json::array();
    for (const LevelReport& level : object.levels)
      levels.push_back({{"fragments", level.fragments},
                        {"triangles", level.triangles},
                        {"without_area", level.flat},
                        {"open_edges", level.open_edges},
                        {"volume", level.volume}});
    json["objects"].push_back({{"id", object.id}, {"levels", levels}});
  }
  return json_text(json, 2) + "\n";
}

}  // namespace voxweld
