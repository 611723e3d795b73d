#include "storage/support/hash.h"

#include <fmt/format.h>

#include <bit>
#include <new>

#include "storage/support/hash_avx2.h"

// Compiled in, so that the states are those of hash_avx2.cpp.
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace voxweld {
namespace {

Hash128 from_xxh(XXH128_hash_t h) {
  return {h.low64, h.high64};
}

const WideHash* wide_hash() {
  static const WideHash* const wide = hash_avx2();
  return wide;
}

XXH3_state_t* xxh(void* state) {
  return static_cast<XXH3_state_t*>(state);
}

}  // namespace

Hash128 hash_bytes(std::span<const std::byte> bytes) {
  if (const WideHash* wide = wide_hash()) return wide->hash(bytes.data(), bytes.size());
  return from_xxh(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string to_hex(Hash128 hash) {
  return fmt::format("{:016x}{:016x}", hash.hi, hash.lo);
}

StreamHasher::StreamHasher() : state_(XXH3_createState()) {
  if (state_ == nullptr) throw std::bad_alloc();
  XXH3_128bits_reset(xxh(state_.get()));
}
void StreamHasher::Free::operator()(void* state) const {
  XXH3_freeState(xxh(state));
}
void StreamHasher::update(std::span<const std::byte> data) {
  if (const WideHash* wide = wide_hash())
    wide->update(state_.get(), data.data(), data.size());
  else
    XXH3_128bits_update(xxh(state_.get()), data.data(), data.size());
}
Hash128 StreamHasher::finish() const {
  return from_xxh(XXH3_128bits_digest(xxh(state_.get())));
}

KeyHasher& KeyHasher::integer(std::int64_t value) {
  std::byte little[8];
  for (int i = 0; i < 8; ++i)
    little[i] = static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xff);
  fed_.update(little);
  return *this;
}

KeyHasher& KeyHasher::bytes(std::span<const std::byte> data) {
  integer(static_cast<std::int64_t>(data.size()));
  fed_.update(data);
  return *this;
}

KeyHasher& KeyHasher::text(std::string_view value) {
  return bytes(std::as_bytes(std::span(value.data(), value.size())));
}

KeyHasher& KeyHasher::real(double value) {
  return integer(std::bit_cast<std::int64_t>(value));
}

KeyHasher& KeyHasher::hash(Hash128 value) {
  integer(static_cast<std::int64_t>(value.lo));
  return integer(static_cast<std::int64_t>(value.hi));
}

}  // namespace voxweld
