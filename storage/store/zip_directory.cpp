#include "storage/store/zip_directory.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::uint32_t end_mark = 0x06054b50, end64_mark = 0x06064b50, locator_mark = 0x07064b50;
constexpr std::uint32_t member_mark = 0x02014b50, local_mark = 0x04034b50;
constexpr std::size_t end_bytes = 22, end64_bytes = 56, locator_bytes = 20, member_bytes = 46,
                      local_bytes = 30;
constexpr std::uint32_t in_zip64 = 0xffffffff;  // a 32-bit field whose value is among the extras

using Bytes = std::span<const std::byte>;

// Little-endian, of 2, 4 or 8 bytes. Precondition: they are there.
std::uint64_t number_at(Bytes bytes, std::size_t at, std::size_t width) {
  std::uint64_t value = 0;
  for (std::size_t i = width; i-- > 0;)
    value = value << 8 | std::to_integer<std::uint64_t>(bytes[at + i]);
  return value;
}

[[noreturn]] void fail_zip(const ReadFile& file, const std::string& what) {
  throw FormatError(file.path() + ": damaged zip file: " + what);
}

std::vector<std::byte> bytes_at(const ReadFile& file, std::uint64_t offset, std::uint64_t size) {
  std::vector<std::byte> bytes(size);
  file.read(offset, bytes);
  return bytes;
}

// Where the list of members is.
struct Span {
  std::uint64_t offset = 0, size = 0, entries = 0;
};

// The larger numbers of a zip64 file; `end` is where the ordinary end record lies.
std::optional<Span> zip64_span(const ReadFile& file, std::uint64_t end) {
  if (end < locator_bytes) return std::nullopt;
  const auto locator = bytes_at(file, end - locator_bytes, locator_bytes);
  if (number_at(locator, 0, 4) != locator_mark) return std::nullopt;
  const std::uint64_t at = number_at(locator, 8, 8);
  if (at > end || end - at < end64_bytes)
    fail_zip(file, fmt::format("its zip64 record is said to be at byte {}", at));
  const auto record = bytes_at(file, at, end64_bytes);
  if (number_at(record, 0, 4) != end64_mark)
    fail_zip(file, fmt::format("no zip64 record at byte {}", at));
  return Span{number_at(record, 48, 8), number_at(record, 40, 8), number_at(record, 32, 8)};
}

Span find_members(const ReadFile& file) {
  constexpr std::uint64_t longest_comment = 0xffff;
  const std::uint64_t tail = std::min<std::uint64_t>(file.size(), end_bytes + longest_comment);
  const auto bytes = bytes_at(file, file.size() - tail, tail);
  for (std::size_t at = tail < end_bytes ? 0 : tail - end_bytes + 1; at-- > 0;) {
    if (number_at(bytes, at, 4) != end_mark) continue;
    const std::uint64_t comment = number_at(bytes, at + 20, 2);
    if (comment != tail - at - end_bytes) continue;  // the mark is part of something else
    if (number_at(bytes, at + 4, 2) != number_at(bytes, at + 6, 2))
      throw FormatError(file.path() + ": a zip file of several volumes is not supported");
    const std::uint64_t end = file.size() - tail + at;
    const Span span{number_at(bytes, at + 16, 4), number_at(bytes, at + 12, 4),
                    number_at(bytes, at + 10, 2)};
    const Span found = zip64_span(file, end).value_or(span);
    if (found.offset > end || found.size > end - found.offset)
      fail_zip(file, fmt::format("its list of members is said to have {} bytes at {}, and ends "
                                 "before {}",
                                 found.size, found.offset, end));
    return found;
  }
  fail_zip(file, "no list of members at its end; it may be cut short");
}

// The values of zip64's extra field, in the order of those that need it.
void take_zip64(const ReadFile& file, Bytes extra, ZipMember& member) {
  while (extra.size() >= 4) {
    const std::size_t size = number_at(extra, 2, 2);
    if (size > extra.size() - 4) break;
    if (number_at(extra, 0, 2) == 1) {
      Bytes values = extra.subspan(4, size);
      for (std::uint64_t* field : {&member.size, &member.packed, &member.offset}) {
        if (*field != in_zip64) continue;
        if (values.size() < 8) fail_zip(file, "a zip64 field is cut short");
        *field = number_at(values, 0, 8);
        values = values.subspan(8);
      }
      return;
    }
    extra = extra.subspan(4 + size);
  }
}

}  // namespace

std::map<std::string, ZipMember> read_zip_directory(const ReadFile& file) {
  const Span span = find_members(file);
  const auto list = bytes_at(file, span.offset, span.size);
  std::map<std::string, ZipMember> members;
  Bytes rest = list;
  for (std::uint64_t i = 0; i < span.entries; ++i) {
    if (rest.size() < member_bytes || number_at(rest, 0, 4) != member_mark)
      fail_zip(file, fmt::format("its list holds {} members, {} expected", i, span.entries));
    const std::size_t name = number_at(rest, 28, 2), extra = number_at(rest, 30, 2),
                      comment = number_at(rest, 32, 2);
    if (rest.size() - member_bytes < name + extra + comment)
      fail_zip(file, fmt::format("member {} of its list is cut short", i));
    ZipMember member;
    member.flags = static_cast<std::uint16_t>(number_at(rest, 8, 2));
    member.method = static_cast<std::uint16_t>(number_at(rest, 10, 2));
    member.crc = static_cast<std::uint32_t>(number_at(rest, 16, 4));
    member.packed = number_at(rest, 20, 4);
    member.size = number_at(rest, 24, 4);
    member.offset = number_at(rest, 42, 4);
    take_zip64(file, rest.subspan(member_bytes + name, extra), member);
    std::string key(reinterpret_cast<const char*>(rest.data() + member_bytes), name);
    rest = rest.subspan(member_bytes + name + extra + comment);
    if (!key.empty() && key.back() == '/') continue;
    members.insert_or_assign(std::move(key), member);  // of one name the last counts
  }
  return members;
}

std::uint64_t zip_member_data(const ReadFile& file, const std::string& name,
                              const ZipMember& member) {
  const auto wrong = [&](const std::string& what) {
    fail_zip(file, "member '" + name + "': " + what);
  };
  if (member.offset > file.size() || file.size() - member.offset < local_bytes)
    wrong(fmt::format("said to be at byte {}, the file has {}", member.offset, file.size()));
  const auto header = bytes_at(file, member.offset, local_bytes);
  if (number_at(header, 0, 4) != local_mark)
    wrong(fmt::format("no header of a member at byte {}", member.offset));
  const std::uint64_t named = number_at(header, 26, 2);
  const std::uint64_t data = member.offset + local_bytes + named + number_at(header, 28, 2);
  if (data <= file.size()) {
    const auto own = bytes_at(file, member.offset + local_bytes, named);
    if (!std::ranges::equal(own, std::as_bytes(std::span(name))))
      wrong("the list of members has it under another name than its header");
  }
  if (data > file.size() || member.packed > file.size() - data)
    wrong(fmt::format("{} bytes at {}, the file has {}", member.packed, data, file.size()));
  return data;
}

}  // namespace voxweld
