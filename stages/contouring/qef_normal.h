// The ordinary representation of a QEF (A^T A, A^T b, b^T b), in floats and in the volume's
// coordinates, as the paper's section 2 has it before the QR form: kept so that its figure 7, which
// shows what the cancellation does, can be run. Selected by simplify.qef = "normal".
#pragma once

#include "stages/contouring/qef.h"

namespace voxweld {

// Same batches as QefKernels, the ten numbers of each lane holding xx xy xz ax yy yz ay zz az bb,
// rounded to float after every step. centre: each lane's node centre in the volume's coordinates.
void reduce_normal(const PlaneBatch& batch, const std::array<Vec3, lanes>& centre,
                   FactorBatch& out);
void merge_normal(const ChildBatch& batch, Vec3 half, FactorBatch& out);
void solve_normal(const FactorBatch& factor, const std::array<Vec3, lanes>& centre,
                  const std::array<LaneBox, lanes>& boxes, double threshold, SolutionBatch& out);

}  // namespace voxweld
