// Label volumes for tests.
#pragma once

#include <set>

#include "tests/pipeline/run/scene.h"

namespace voxweld::testing {

// A lattice of balls, each of its own label, 0 between them; some touch, some the border. 64-bit
// labels are above 2^40.
RawVolume ball_labels(SampleType type, Index3 size);

// u16: the regions 1 .. labels of random points, and this part of the samples of any of the labels
// from 0 on.
RawVolume cell_labels(Index3 size, std::uint32_t labels, double noise, unsigned seed);

// The values a volume has.
std::set<std::uint64_t> labels_of(const RawVolume& volume);

// The files of one label, or of the only surface, by the place of their tile.
Tree label_files(const std::filesystem::path& output, std::uint64_t label);

// The main promise: a label's mesh among all labels' is the mesh of a run of that label alone. At
// least so many labels have several tiles.
void expect_labels_as_alone(const RawVolume& volume, const Settings& settings,
                            std::size_t several_tiles);

}  // namespace voxweld::testing
