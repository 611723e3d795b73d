#include "pipeline/run/stamp.h"

#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

std::filesystem::path stamp_path(const std::filesystem::path& folder) {
  return folder / "volume.stamp";
}

// The stamp's digits twice over: a damaged one is none.
std::string stamp_text(Hash128 stamp) {
  return to_hex(stamp) + "\n" + to_hex(hash_bytes(as_bytes(to_hex(stamp)))) + "\n";
}

Hash128 from_hex(const std::string& hex) {
  const auto half = [&](std::size_t at) { return std::stoull(hex.substr(at, 16), nullptr, 16); };
  return {half(16), half(0)};
}

}  // namespace

std::optional<Hash128> read_stamp(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(stamp_path(folder))) return std::nullopt;
  const auto bytes = read_whole_file(stamp_path(folder));
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.size() < 32 || text.find_first_not_of("0123456789abcdef") < 32) return std::nullopt;
  const Hash128 stamp = from_hex(text.substr(0, 32));
  if (text != stamp_text(stamp)) return std::nullopt;
  return stamp;
}

void write_stamp(const std::filesystem::path& folder, Hash128 stamp) {
  write_whole_file(stamp_path(folder), as_bytes(stamp_text(stamp)), Durability::rename_only);
}

}  // namespace voxweld
