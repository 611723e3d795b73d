#include "stages/refine/threshold.h"

#include <algorithm>
#include <cmath>

namespace voxweld {
namespace {

constexpr double parts = 16;  // of the way between two tolerances

// 2^(quarter / 4), the same on every machine.
double power_of_two(int quarter) {
  const double root = std::sqrt(2.0);
  const int octave = quarter >> 2;
  const double part = ((quarter & 1) != 0 ? std::sqrt(root) : 1) * ((quarter & 2) != 0 ? root : 1);
  return std::ldexp(part, octave);
}

// Measured: what the second pass takes of what the first has left, and how many triangles stay for
// each that neither may change.
constexpr double more_in_the_end = 0.915, around_held = 10;

constexpr int largest = 24;  // quarters of octaves above a cell

// totals: what each tolerance leaves; before: what none does.
CollapseThreshold threshold(double before, std::vector<double> totals,
                            const std::vector<double>& tolerances, std::uint64_t triangles) {
  const auto wanted = static_cast<double>(triangles);
  const auto rounded = [](double count) { return static_cast<std::uint64_t>(std::llround(count)); };
  if (before <= wanted || tolerances.empty()) return {0, rounded(before), before <= wanted};
  double most = before;
  for (double& total : totals) total = most = std::min(most, total);
  const auto found = std::ranges::partition_point(totals, [&](double n) { return n > wanted; });
  if (found == totals.end()) {
    // No further than is of use.
    const auto enough =
        std::ranges::partition_point(totals, [&](double n) { return n > 1.01 * totals.back(); });
    return {tolerances[static_cast<std::size_t>(enough - totals.begin())], rounded(*enough), false};
  }
  const auto k = static_cast<std::size_t>(found - totals.begin());
  const double above = k == 0 ? before : totals[k - 1], from = k == 0 ? 0 : tolerances[k - 1];
  const double way = std::ceil(parts * (above - wanted) / (above - totals[k])) / parts;
  return {from + (tolerances[k] - from) * way, rounded(above + (totals[k] - above) * way), true};
}

}  // namespace

std::vector<double> survey_tolerances(double cell) {
  std::vector<double> all;
  // Where most surfaces lose their triangles the steps are smaller.
  for (int quarter = -40; quarter <= largest; quarter += quarter < -16 || quarter >= 0 ? 4 : 2)
    all.push_back(cell * power_of_two(quarter));
  return all;
}

std::vector<double> recount_tolerances(double first, double cell) {
  std::vector<double> all;
  if (first == 0) return all;
  const double most = cell * power_of_two(largest);
  for (int quarter = -12; quarter <= 12; quarter += quarter < -4 || quarter >= 4 ? 4 : 1)
    if (const double one = first * power_of_two(quarter); one <= most) all.push_back(one);
  return all;
}

CollapseThreshold first_threshold(const CollapseSurvey& survey,
                                  const std::vector<double>& tolerances, std::uint64_t triangles) {
  const auto inside = static_cast<double>(survey.inside), fixed = static_cast<double>(survey.fixed);
  const auto held = static_cast<double>(survey.held), border = static_cast<double>(survey.border);
  const double all = inside + fixed;
  std::vector<double> totals;
  for (const std::uint64_t left : survey.left) {
    // The root r of the part that is left: inside r^2 = left - border (1 - r).
    const double within = std::max(0.0, static_cast<double>(left) - border);
    const double r =
        inside > 0 ? (border + std::sqrt(border * border + 4 * inside * within)) / (2 * inside) : 1;
    totals.push_back(std::min(all, more_in_the_end * all * r * r + around_held * held * (1 - r)));
  }
  return threshold(all, std::move(totals), tolerances, triangles);
}

CollapseThreshold second_threshold(const CollapseSurvey& recount,
                                   const std::vector<double>& tolerances, std::uint64_t triangles) {
  std::vector<double> totals;
  for (const std::uint64_t left : recount.left)
    totals.push_back(static_cast<double>(left) + static_cast<double>(recount.fixed));
  return threshold(static_cast<double>(recount.all()), std::move(totals), tolerances, triangles);
}

}  // namespace voxweld
