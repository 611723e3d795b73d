#include "storage/image/tiff_directories.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <unordered_set>

namespace voxweld {
namespace {

constexpr std::size_t classic_header = 8, big_header = 16;

std::uint64_t decode(std::span<const std::byte> bytes, bool big_endian) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::size_t at = big_endian ? i : bytes.size() - 1 - i;
    value = (value << 8) | std::to_integer<std::uint64_t>(bytes[at]);
  }
  return value;
}

class Walker {
 public:
  Walker(const ReadFile& file, TiffDirectories& out) : file_(file), out_(out) {}

  // False when this is no TIFF. `next` is then the offset of the first directory.
  bool header(std::uint64_t& next) {
    std::array<std::byte, big_header> bytes{};
    if (file_.size() < classic_header) return false;
    file_.read(0, std::span(bytes).first(std::min<std::uint64_t>(file_.size(), bytes.size())));
    const auto order = std::to_integer<char>(bytes[0]);
    if (bytes[0] != bytes[1] || (order != 'I' && order != 'M')) return false;
    out_.big_endian = order == 'M';
    const std::uint64_t version = decode(std::span(bytes).subspan(2, 2), out_.big_endian);
    if (version != 42 && version != 43) return false;
    out_.big = version == 43;
    if (out_.big && file_.size() < big_header) return false;
    next = out_.big ? decode(std::span(bytes).subspan(8, 8), out_.big_endian)
                    : decode(std::span(bytes).subspan(4, 4), out_.big_endian);
    return true;
  }

  bool chain(std::uint64_t next, std::string& error) {
    const std::uint64_t count_bytes = out_.big ? 8 : 2, entry_bytes = out_.big ? 20 : 12,
                        link_bytes = out_.big ? 8 : 4;
    std::unordered_set<std::uint64_t> seen;
    while (next != 0) {
      std::uint64_t entries = 0;
      const std::uint64_t here = next;
      const bool inside = number(here, count_bytes, entries) &&
                          entries <= file_.size() / entry_bytes &&
                          number(here + count_bytes + entries * entry_bytes, link_bytes, next);
      if (!inside) {
        error = fmt::format(
            "the directory of page {} (at byte {}) goes beyond the end of the file ({} bytes): it "
            "is "
            "truncated",
            out_.offsets.size() + 1, here, file_.size());
        return false;
      }
      if (!seen.insert(here).second) {
        error =
            fmt::format("the directory of page {} is that of an earlier page again: it is damaged",
                        out_.offsets.size() + 1);
        return false;
      }
      out_.offsets.push_back(here);
    }
    return true;
  }

 private:
  bool number(std::uint64_t offset, std::uint64_t bytes, std::uint64_t& value) const {
    std::array<std::byte, 8> buffer{};
    if (offset > file_.size() || file_.size() - offset < bytes) return false;
    const auto part = std::span(buffer).first(bytes);
    file_.read(offset, part);
    value = decode(part, out_.big_endian);
    return true;
  }

  const ReadFile& file_;
  TiffDirectories& out_;
};

}  // namespace

bool list_tiff_directories(const ReadFile& file, TiffDirectories& out, std::string& error) {
  Walker walker(file, out);
  std::uint64_t first = 0;
  if (!walker.header(first)) return false;
  if (!walker.chain(first, error)) return false;
  if (out.offsets.empty()) error = "a TIFF without any page: it was not written to its end";
  return error.empty();
}

}  // namespace voxweld
