// The filters keep and fill: pieces of the volume that are connected through faces of samples, found
// without the volume in memory. Pieces of what is inside the surface, of which some are kept; or of
// what is outside and does not reach the volume's border, of which some are filled.
//
// One pass over the volume finds them and leaves an artifact that says of each block which of its
// pieces change. Reading finds a block's pieces again and changes those.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "pipeline/stage/context.h"
#include "stages/contouring/inside_test.h"
#include "storage/support/hash.h"
#include "storage/types/isovalue.h"
#include "storage/types/volume.h"

namespace voxweld {

struct PieceRule {
  enum class What : std::uint8_t { keep, fill };
  What what = What::keep;
  // keep: those of at least so many samples; 0: the one that has most, of several that one which
  // comes first (by z, then y, then x of its first sample). fill: those of at most so many.
  std::uint64_t voxels = 0;
  Isovalue isovalue;              // in stored values
  Inside inside = Inside::above;  // of stored values
  // What the samples become, in stored values; empty: the least sample of the volume that is there
  // (keep above, fill below) or the greatest (keep below, fill above).
  std::optional<double> value{};
};

// Finds the pieces and writes the artifact at `path`, known by `key`; nothing to do where it is
// there with that key. Memory: as run.memory has it; InputError where one layer of blocks has too
// many pieces for that. Units run on `context`'s executor threads of this process.
// source: of Access::box. Throws what it throws.
void find_pieces(RunContext& context, const SampleSource& source, const PieceRule& rule,
                 const std::filesystem::path& path, Hash128 key);
bool pieces_are_found(const std::filesystem::path& path, Hash128 key);

// What is left of `before`, which is read by boxes. The artifact, which knows the rule, is opened
// when samples are first read; then DamagedArtifact where it is missing, damaged or not of that key.
// Same info but for access, largest_decode and chunk: a block of 64 samples a side that changes is
// found again whole.
std::shared_ptr<SampleSource> pieces_source(std::shared_ptr<SampleSource> before,
                                            std::filesystem::path path, Hash128 key);

}  // namespace voxweld
