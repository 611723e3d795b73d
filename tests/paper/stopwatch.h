// Times on a machine that others use too: the processor's, of one thread, in milliseconds.
#pragma once

#include <algorithm>
#include <ctime>
#include <vector>

namespace voxweld::paper {

inline double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

template <class F>
double processor_ms(F&& f) {
  const double start = thread_ms();
  f();
  return thread_ms() - start;
}

// Precondition: not empty.
inline double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Of so many turns of f, which returns a time.
template <class F>
double median(int turns, F&& f) {
  std::vector<double> times;
  for (int i = 0; i < turns; ++i) times.push_back(f());
  return median_of(times);
}

}  // namespace voxweld::paper
