// Content hashes (XXH3, 128 bits) and the keys made of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
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

// The hash of long data fed in pieces, which may be cut anywhere.
class StreamHasher {
 public:
  StreamHasher();
  void update(std::span<const std::byte> data);
  Hash128 finish() const;

 private:
  struct Free {
    void operator()(void* state) const;
  };
  std::unique_ptr<void, Free> state_;
};

// Builds a key from named, length-prefixed fields: no two different sequences of fields feed the
// same bytes. Doubles enter by their bits.
class KeyHasher {
 public:
  KeyHasher& bytes(std::span<const std::byte> data);  // length-prefixed
  KeyHasher& text(std::string_view value);
  KeyHasher& integer(std::int64_t value);
  KeyHasher& real(double value);
  KeyHasher& hash(Hash128 value);
  Hash128 finish() const { return fed_.finish(); }

 private:
  StreamHasher fed_;
};

}  // namespace voxweld
