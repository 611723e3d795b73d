#include "storage/support/hash_avx2.h"

#ifdef __AVX2__
#define XXH_INLINE_ALL
#include <xxhash.h>
#endif

namespace voxweld {

HashUpdate hash_update_avx2() {
#ifdef __AVX2__
  if (__builtin_cpu_supports("avx2"))
    return [](void* state, const void* data, std::size_t size) {
      XXH3_128bits_update(static_cast<XXH3_state_t*>(state), data, size);
    };
#endif
  return nullptr;
}

}  // namespace voxweld
