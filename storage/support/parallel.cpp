#include "storage/support/parallel.h"

#ifndef __SANITIZE_THREAD__
#include <tbb/parallel_for.h>
#endif

namespace voxweld {

void for_each_index(std::size_t count, const std::function<void(std::size_t)>& f) {
#ifdef __SANITIZE_THREAD__
  // The thread sanitizer does not see how a oneTBB built without it synchronizes.
  for (std::size_t i = 0; i < count; ++i) f(i);
#else
  if (count == 1) return f(0);
  tbb::parallel_for(std::size_t{0}, count, f, tbb::simple_partitioner());
#endif
}

}  // namespace voxweld
