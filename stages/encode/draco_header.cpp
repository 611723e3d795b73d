// Based on: the Draco bitstream specification, version 2.2, sections "Draco Decoder", "Edgebreaker
// Decoder" and "Sequential Connectivity Decoder".
#include <fmt/format.h>

#include <cstdint>
#include <string_view>

#include "stages/encode/draco_mesh.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t fixed_size = 11;  // "DRACO", version 2, type 1, method 1, flags 2
constexpr int type_mesh = 1;
constexpr int method_sequential = 0, method_edgebreaker = 1;

// Entropy coding of a flat regular mesh has no lower bound worth the name, so this only keeps a
// damaged count from asking for gigabytes.
constexpr std::uint64_t plausible_count(std::uint64_t bytes) {
  return (std::uint64_t{1} << 22) + 1024 * bytes;
}

class Cursor {
 public:
  Cursor(std::span<const std::byte> bytes, const std::string& where)
      : bytes_(bytes), where_(where) {}

  int byte() {
    if (at_ >= bytes_.size())
      throw FormatError(
          fmt::format("{}: truncated Draco data: it ends after {} bytes", where_, bytes_.size()));
    return std::to_integer<int>(bytes_[at_++]);
  }
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      const int b = byte();
      value |= static_cast<std::uint64_t>(b & 0x7f) << shift;
      if ((b & 0x80) == 0) return value;
    }
    damaged("a count has more than 32 bits");
  }
  void skip(std::uint64_t count) {
    if (count > bytes_.size() - at_) damaged("its metadata states more than there is");
    at_ += count;
  }
  [[noreturn]] void damaged(const char* what) const {
    throw FormatError(where_ + ": damaged Draco data: " + what);
  }

 private:
  std::span<const std::byte> bytes_;
  const std::string& where_;
  std::size_t at_ = 0;
};

constexpr int most_nested = 8;

// Entries of a name and a value each, then the same again for each part.
void skip_entries(Cursor& cursor, int depth) {
  for (std::uint64_t entry = cursor.varint(); entry > 0; --entry) {
    cursor.skip(static_cast<std::uint64_t>(cursor.byte()));
    cursor.skip(cursor.varint());
  }
  for (std::uint64_t part = cursor.varint(); part > 0; --part) {
    if (depth == most_nested) cursor.damaged("its metadata is nested too deeply");
    cursor.skip(static_cast<std::uint64_t>(cursor.byte()));
    skip_entries(cursor, depth + 1);
  }
}

void skip_metadata(Cursor& cursor) {
  for (std::uint64_t attribute = cursor.varint(); attribute > 0; --attribute) {
    cursor.varint();  // its id
    skip_entries(cursor, 0);
  }
  skip_entries(cursor, 0);
}

}  // namespace

void check_draco_header(std::span<const std::byte> bytes, const std::string& where) {
  Cursor cursor(bytes, where);
  for (const char expected : std::string_view("DRACO")) {
    if (cursor.byte() != expected)
      throw FormatError(where + ": not Draco data: it does not start with \"DRACO\"");
  }
  const int major = cursor.byte(), minor = cursor.byte();
  const int type = cursor.byte(), method = cursor.byte();
  const int flags = cursor.byte() | cursor.byte() << 8;
  if (major != 2 || minor != 2)
    throw FormatError(
        fmt::format("{}: Draco bitstream version {}.{}, expected 2.2", where, major, minor));
  if (type != type_mesh)
    throw FormatError(
        fmt::format("{}: Draco geometry type {}, expected {} (a mesh)", where, type, type_mesh));
  if (method != method_sequential && method != method_edgebreaker)
    throw FormatError(fmt::format("{}: Draco encoding method {}, expected 0 or 1", where, method));
  constexpr int with_metadata = 0x8000;
  if ((flags & ~with_metadata) != 0)
    throw FormatError(
        fmt::format("{}: Draco flags {:#x}, expected 0 or 0x8000 (metadata)", where, flags));
  if (flags != 0) skip_metadata(cursor);
  if (method == method_edgebreaker) cursor.byte();  // traversal type
  for (int i = 0; i < 2; ++i) {                     // vertices and faces, or faces and points
    const std::uint64_t count = cursor.varint();
    if (count == 0 || count > plausible_count(bytes.size()))
      throw FormatError(
          fmt::format("{}: damaged Draco data: {} bytes state {} vertices or "
                      "triangles",
                      where, bytes.size(), count));
  }
}

}  // namespace voxweld
