#include "storage/vdb/vdb_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t most_listed_grids = 50;

std::string facts_text(const VdbGrid& grid) {
  std::string text = fmt::format("{}{}, {}", grid.type, grid.half ? " as half" : "",
                                 grid.grid_class[0] == '\0' ? "no class" : grid.grid_class);
  // Of a grid without active voxels the header has a box that ends before it begins.
  if (grid.has_box && grid.last[0] < grid.first[0])
    text += ", no active voxel";
  else if (grid.has_box)
    text += fmt::format(", active box ({}, {}, {}) to ({}, {}, {})", grid.first[0], grid.first[1],
                        grid.first[2], grid.last[0], grid.last[1], grid.last[2]);
  return text;
}

std::string listed_grids(std::span<const VdbGrid> grids) {
  std::string text;
  for (std::size_t i = 0; i < std::min(grids.size(), most_listed_grids); ++i)
    text += (i == 0 ? "" : ", ") + grid_text(grids[i]);
  if (grids.size() > most_listed_grids)
    text += fmt::format(" and {} more", grids.size() - most_listed_grids);
  return text;
}

std::size_t settle_grid(std::span<const VdbGrid> grids, const InputSpec& spec, VolumeInfo& info) {
  if (spec.select.has(Selector::dataset)) {
    for (std::size_t i = 0; i < grids.size(); ++i)
      if (grids[i].name == spec.select.dataset) return i;
    throw InputError(
        fmt::format("{}: no grid '{}': there are {}; correct input.dataset or --dataset", spec.path,
                    spec.select.dataset, listed_grids(grids)));
  }
  if (grids.size() == 1) return 0;  // perhaps to be refused for what it is
  std::vector<std::size_t> readable;
  for (std::size_t i = 0; i < grids.size(); ++i)
    if (grids[i].sample >= 0) readable.push_back(i);
  if (readable.size() == 1) return readable.front();
  if (!spec.survey || readable.empty())
    throw InputError(
        fmt::format("{}: the file has {} grids: {}; choose one: set input.dataset or --dataset",
                    spec.path, grids.size(), listed_grids(grids)));
  info.warnings.push_back(
      fmt::format("{}: the first of {} grids is shown: choose one: set input.dataset or --dataset",
                  spec.path, readable.size()));
  return readable.front();
}

}  // namespace

std::string grid_text(const VdbGrid& grid) {
  return fmt::format("'{}' ({})", grid.name, facts_text(grid));
}

std::size_t chosen_grid(std::span<const VdbGrid> grids, const InputSpec& spec, VolumeInfo& info) {
  if (grids.empty())
    throw FormatError(spec.path + ": the file has no grid: there is nothing in it");
  const std::size_t chosen = settle_grid(grids, spec, info);
  for (std::size_t i = 0; grids.size() > 1 && i < grids.size(); ++i)
    info.choices.push_back({.selector = selector_name(Selector::dataset),
                            .value = grids[i].name,
                            .text = facts_text(grids[i]),
                            .chosen = i == chosen});
  if (grids[chosen].sample < 0)
    throw InputError(fmt::format(
        "{}: grid {}: vectors, points and strings have no surface of a value; expected float, "
        "double, int32, int64, bool or mask: make such a grid of it first{}",
        spec.path, grid_text(grids[chosen]),
        grids.size() > 1 ? ", or choose another with input.dataset or --dataset" : ""));
  return chosen;
}

}  // namespace voxweld
