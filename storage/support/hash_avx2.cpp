#include "storage/support/hash_avx2.h"

#ifdef __AVX2__
#define XXH_INLINE_ALL
#include <xxhash.h>
#endif

namespace voxweld {

const WideHash* hash_avx2() {
#ifdef __AVX2__
  static constexpr WideHash wide{[](void* state, const void* data, std::size_t size) {
                                   XXH3_128bits_update(static_cast<XXH3_state_t*>(state), data,
                                                       size);
                                 },
                                 [](const void* data, std::size_t size) {
                                   const XXH128_hash_t h = XXH3_128bits(data, size);
                                   return Hash128{h.low64, h.high64};
                                 }};
  if (__builtin_cpu_supports("avx2")) return &wide;
#endif
  return nullptr;
}

}  // namespace voxweld
