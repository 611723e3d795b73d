#include "storage/support/hash.h"

#include <xxhash.h>

#include <bit>
#include <new>

namespace voxweld {
namespace {

Hash128 from_xxh(XXH128_hash_t h) {
  return {h.low64, h.high64};
}

XXH3_state_t* new_state() {
  XXH3_state_t* state = XXH3_createState();
  if (state == nullptr) throw std::bad_alloc();
  XXH3_128bits_reset(state);
  return state;
}

}  // namespace

Hash128 hash_bytes(std::span<const std::byte> bytes) {
  return from_xxh(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string to_hex(Hash128 hash) {
  static constexpr char digits[] = "0123456789abcdef";
  std::string text(32, '0');
  for (int i = 0; i < 16; ++i) {
    text[static_cast<std::size_t>(15 - i)] = digits[(hash.hi >> (4 * i)) & 15];
    text[static_cast<std::size_t>(31 - i)] = digits[(hash.lo >> (4 * i)) & 15];
  }
  return text;
}

KeyHasher::KeyHasher() : state_(new_state()) {}
KeyHasher::~KeyHasher() {
  XXH3_freeState(static_cast<XXH3_state_t*>(state_));
}

void KeyHasher::raw(const void* data, std::size_t size) {
  XXH3_128bits_update(static_cast<XXH3_state_t*>(state_), data, size);
}

KeyHasher& KeyHasher::integer(std::int64_t value) {
  std::byte little[8];
  for (int i = 0; i < 8; ++i)
    little[i] = static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xff);
  raw(little, 8);
  return *this;
}

KeyHasher& KeyHasher::bytes(std::span<const std::byte> data) {
  integer(static_cast<std::int64_t>(data.size()));
  raw(data.data(), data.size());
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

Hash128 KeyHasher::finish() const {
  return from_xxh(XXH3_128bits_digest(static_cast<XXH3_state_t*>(state_)));
}

StreamHasher::StreamHasher() : state_(new_state()) {}
StreamHasher::~StreamHasher() {
  XXH3_freeState(static_cast<XXH3_state_t*>(state_));
}
void StreamHasher::update(std::span<const std::byte> data) {
  XXH3_128bits_update(static_cast<XXH3_state_t*>(state_), data.data(), data.size());
}
Hash128 StreamHasher::finish() const {
  return from_xxh(XXH3_128bits_digest(static_cast<XXH3_state_t*>(state_)));
}

}  // namespace voxweld
