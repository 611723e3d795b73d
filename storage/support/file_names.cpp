#include "storage/support/file_names.h"

#include <cstring>

#include "storage/support/hash.h"

namespace voxweld {
namespace {

constexpr std::uint64_t names_bytes = std::uint64_t{8} << 20;

}  // namespace

FileNames::FileNames(const std::filesystem::path& scratch) : names_(scratch, names_bytes) {}

// Sorted by their hashes, equal names come together; the first byte says what is done with one.
void FileNames::push(std::string_view name, bool out) {
  const auto bytes = std::as_bytes(std::span(name.data(), name.size()));
  const Hash128 hash = hash_bytes(bytes);
  record_.assign(1, static_cast<std::byte>(out));
  record_.insert(record_.end(), bytes.begin(), bytes.end());
  names_.push({hash.hi, hash.lo}, record_);
}

void FileNames::each(const std::function<void(const std::string&)>& f) {
  SortKey key, last;
  std::string name;
  bool any = false, out = false;
  const auto finish = [&] {
    if (any && !out) f(name);
  };
  while (names_.next(key, record_)) {
    if (any && key == last) {
      out = out || record_[0] != std::byte{0};
      continue;
    }
    finish();
    any = true;
    last = key;
    out = record_[0] != std::byte{0};
    name.assign(reinterpret_cast<const char*>(record_.data()) + 1, record_.size() - 1);
  }
  finish();
}

}  // namespace voxweld
