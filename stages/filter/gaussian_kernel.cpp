#include <cmath>
#include <utility>

#include "stages/filter/box_sum_kernel.h"

namespace voxweld {
namespace {

using namespace filter_detail;

// e^-x for x >= 0 of + - * / alone: that of the C library differs between processors in the last
// bit.
double falling_exponential(double x) {
  constexpr double ln2_high = 0x1.62e42fee00000p-1, ln2_low = 0x1.a39ef35793c76p-33;
  const double halvings = std::floor(x / ln2_high + 0.5);
  if (halvings > 1100) return 0;
  const double rest = (halvings * ln2_high - x) + halvings * ln2_low;  // |rest| <= ln 2 / 2
  double sum = 1;
  for (int i = 20; i > 0; --i) sum = 1 + sum * rest / i;
  return std::ldexp(sum, -static_cast<int>(halvings));
}

// By distance.
std::vector<double> gaussian_weights(double sigma) {
  const auto radius = static_cast<std::int64_t>(std::floor(4 * sigma + 0.5));
  std::vector<double> weights{1};
  double sum = 0;
  for (std::int64_t k = 1; k <= radius; ++k) {
    const double distance = static_cast<double>(k) / sigma;
    weights.push_back(falling_exponential(0.5 * distance * distance));
  }
  for (std::int64_t k = radius; k > 0; --k) sum += 2 * weights[static_cast<std::size_t>(k)];
  sum += 1;
  for (double& w : weights) w /= sum;
  return weights;
}

}  // namespace

std::unique_ptr<FilterKernel> gaussian_kernel(const SampleGrid& input, Vec3 sigma,
                                              SampleType type) {
  SumAxes axes;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(sigma[axis] > 0)) continue;
    std::vector<double> weights = gaussian_weights(sigma[axis]);
    if (weights.size() == 1) continue;  // of a sigma below 1/8: the sample itself
    axes.radius[axis] = static_cast<std::int64_t>(weights.size()) - 1;
    axes.weights[static_cast<std::size_t>(axis)] = std::move(weights);
  }
  return box_sum_kernel(input, std::move(axes), 1, type);
}

}  // namespace voxweld
