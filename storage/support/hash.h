// Content hashes (XXH3, 128 bits) and the keys made of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace voxweld {

struct Hash128 {
  std::uint64_t lo = 0, hi = 0;
  friend bool operator==(const Hash128&, const Hash128&) = default;
};

Hash128 hash_bytes(std::span<const std::byte> bytes);
std::string to_hex(Hash128 hash);  // 32 lower-case digits, high half first

// Builds a key from named, length-prefixed fields: no two different sequences of fields feed the
// same bytes. Doubles enter by their bits.
class KeyHasher {
 public:
  KeyHasher();
  ~KeyHasher();
  KeyHasher(const KeyHasher&) = delete;
  KeyHasher& operator=(const KeyHasher&) = delete;

  KeyHasher& bytes(std::span<const std::byte> data);  // length-prefixed
  KeyHasher& text(std::string_view value);
  KeyHasher& integer(std::int64_t value);
  KeyHasher& real(double value);
  KeyHasher& hash(Hash128 value);
  Hash128 finish() const;

 private:
  void raw(const void* data, std::size_t size);
  void* state_;
};

// The same, for long data fed in pieces (no prefixes: pieces may be cut anywhere).
class StreamHasher {
 public:
  StreamHasher();
  ~StreamHasher();
  StreamHasher(const StreamHasher&) = delete;
  StreamHasher& operator=(const StreamHasher&) = delete;
  void update(std::span<const std::byte> data);
  Hash128 finish() const;

 private:
  void* state_;
};

}  // namespace voxweld
