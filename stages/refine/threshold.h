// Which tolerances of collapse leave so many triangles.
//
// A pass cannot change what crosses the borders of its cubes, so after the first pass there can be no
// more than a guess: as if what is there went like the rest. A patch of surface keeps a triangle for
// each vertex at a border that stays fine. Had that got coarser too, it would have as many fewer
// vertices as the patch has along a line, the root of the part that is left.
// What the second pass leaves is counted for each tolerance once the first is done, so the second
// tolerance makes up for the guess.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/types/collapse_survey.h"

namespace voxweld {

// The tolerances that are tried in the first pass, in lattice steps: from cell / 1024 to 64 cells, by
// the root of two. cell: the smallest side, in lattice steps.
std::vector<double> survey_tolerances(double cell);
// And in the second, around that of the first; none where that is 0.
std::vector<double> recount_tolerances(double first, double cell);

struct CollapseThreshold {
  double tolerance = 0;         // lattice steps
  std::uint64_t triangles = 0;  // about what it leaves
  bool reached = true;          // no more than were asked for
  friend bool operator==(const CollapseThreshold&, const CollapseThreshold&) = default;
};

// The smallest that leaves at most `triangles` of the mesh once both passes are done, to a sixteenth
// of the way between two that were tried: so a few triangles more or less seldom change it. 0 where
// there are no more before anything is done, the largest where even that leaves more.
// survey: of all cubes, with the tolerances of survey_tolerances().
CollapseThreshold first_threshold(const CollapseSurvey& survey,
                                  const std::vector<double>& tolerances, std::uint64_t triangles);
// The same of the second pass. recount: with those of recount_tolerances().
CollapseThreshold second_threshold(const CollapseSurvey& recount,
                                   const std::vector<double>& tolerances, std::uint64_t triangles);

}  // namespace voxweld
