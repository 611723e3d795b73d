// The units of labels (labels.mode = "each"), as merge and retile plan them: small labels several at
// a time.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "storage/artifact/material_top.h"
#include "storage/support/hash.h"

namespace voxweld {

// Labels of one tile put together until a batch is full. Another way to do that is another version
// of all plans that have batches: top_version, tile_plan_version.
class BatchPlanner {
 public:
  BatchPlanner(MaterialTablesWriter& out, std::uint64_t most_vertices)
      : out_(out), most_vertices_(most_vertices) {}

  // What a unit's result depends on, of one of its tiles.
  using AddInputs = std::function<void(KeyHasher&, const PlannedTile&)>;
  // The label that was ended last in `out`, with its tiles.
  void add(Material material, std::span<const PlannedTile> tiles, std::uint64_t largest_piece,
           const AddInputs& add_inputs);
  void finish();

 private:
  bool ends_before(Material material, const PlannedTile& tile) const;
  void begin(Material material, std::uint64_t surface, std::uint64_t first_tile,
             std::uint64_t surface_tiles, const PlannedTile& tile);

  MaterialTablesWriter& out_;
  std::uint64_t most_vertices_;
  BatchRecord batch_;  // under way while key_ is
  std::optional<KeyHasher> key_;
};

}  // namespace voxweld
