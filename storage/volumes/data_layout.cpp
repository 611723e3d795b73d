#include "storage/volumes/data_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "storage/support/byte_order.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/decoded_stream.h"
#include "storage/volumes/inflate_stream.h"

namespace voxweld {
namespace {

constexpr std::uint64_t max_volume_bytes = std::uint64_t{1} << 62;

void note_file(const ReadFile& file, std::vector<InputFile>& files) {
  // Headers come first and one file is at most the last one noted again.
  if (!files.empty() && (files.front().path == file.path() || files.back().path == file.path()))
    return;
  files.push_back({file.path(), file.state()});
}

void skip_lines(const ReadFile& file, DataLayout::Part& part) {
  if (part.skip_lines == 0) return;
  LineReader lines(file, part.offset);
  for (int i = 0; i < part.skip_lines; ++i)
    if (!lines.next())
      throw FormatError(fmt::format("{}: {} lines to skip before the samples, but the file has {}",
                                    file.path(), part.skip_lines, i));
  part.offset = lines.offset();
  part.skip_lines = 0;
}

[[noreturn]] void fail_truncated(const ReadFile& file, std::uint64_t offset, std::uint64_t bytes) {
  throw FormatError(
      fmt::format("{}: truncated: the header announces {} bytes of samples from byte {} on, {} in "
                  "all, but the file has {}: get a complete copy or correct the sizes",
                  file.path(), bytes, offset, offset + bytes, file.size()));
}

// The two settle one part: its place is checked. They return what the user should hear, or nothing.
std::string settle_raw(const ReadFile& file, DataLayout::Part& part, const DataLayout& layout,
                       std::uint64_t bytes) {
  if (layout.samples_at_end) {
    if (file.size() < bytes) fail_truncated(file, 0, bytes);
    part.offset = file.size() - bytes;
    return {};
  }
  part.offset += static_cast<std::uint64_t>(layout.skip_bytes);
  if (part.stored_bytes && *part.stored_bytes < bytes)
    throw FormatError(fmt::format(
        "{}: {} bytes from byte {} on are the samples', but the sizes need {}: correct the header",
        file.path(), *part.stored_bytes, part.offset, bytes));
  if (part.offset > file.size() || file.size() - part.offset < bytes)
    fail_truncated(file, part.offset, bytes);
  if (part.stored_bytes) return {};
  if (const std::uint64_t rest = file.size() - part.offset - bytes; rest > 0)
    return fmt::format(
        "{}: {} bytes after the samples are ignored ({} expected from byte {} on, the "
        "file has {}): if the picture looks sheared, check size and type",
        file.path(), rest, bytes, part.offset, file.size());
  return {};
}

// Deflate makes at most this many bytes of one: a header that announces more is wrong, and to find
// that out by reading would take as long as it likes.
constexpr std::uint64_t best_deflate_ratio = 1032;

// A block of bzip2 is of 900 kB at most, in which a run of 259 equal bytes takes 5, and takes 32 bytes
// at least in the file.
constexpr std::uint64_t best_bzip2_ratio = 900'000 / 5 * 259 / 32;
constexpr std::uint64_t best_rle_ratio = 64;

std::uint64_t best_ratio_of(DataEncoding encoding) {
  return encoding == DataEncoding::bzip2      ? best_bzip2_ratio
         : encoding == DataEncoding::byte_rle ? best_rle_ratio
                                              : best_deflate_ratio;
}

void check_packed_size(const ReadFile& file, const DataLayout::Part& part, DataEncoding encoding,
                       std::uint64_t needed) {
  const std::uint64_t stored = std::min(file.size() - std::min(file.size(), part.offset),
                                        part.stored_bytes.value_or(file.size()));
  const std::uint64_t ratio = best_ratio_of(encoding);
  if (needed / ratio <= stored) return;
  throw FormatError(fmt::format(
      "{}: truncated: the header announces {} bytes of samples, but the file's {} compressed bytes "
      "hold at most {}: get a complete copy or correct the sizes",
      file.path(), needed, stored, stored * ratio));
}

// Each number takes a digit. Of the separators the one who reads knows more.
void check_text_size(const ReadFile& file, const DataLayout::Part& part, const DataLayout& layout,
                     std::uint64_t samples) {
  const std::uint64_t offset = part.offset + static_cast<std::uint64_t>(layout.skip_bytes);
  const std::uint64_t rest = std::min(file.size() - std::min(file.size(), offset),
                                      part.stored_bytes.value_or(file.size()));
  if (rest >= samples) return;
  throw FormatError(fmt::format(
      "{}: truncated: the header announces {} samples, but the {} bytes of text from byte {} on "
      "hold fewer: get a complete copy or correct the sizes",
      file.path(), samples, rest, offset));
}

std::string settle_deflated(const ReadFile& file, const DataLayout::Part& part,
                            const DataLayout& layout, std::uint64_t bytes) {
  std::vector<std::byte> head(static_cast<std::size_t>(
      part.offset < file.size() ? std::min<std::uint64_t>(3, file.size() - part.offset) : 0));
  file.read(part.offset, head);
  if (!looks_deflated(head))
    throw FormatError(fmt::format(
        "{}: the header announces compressed samples from byte {} on, but there is no gzip or zlib "
        "stream there: correct the encoding, the offset or the file",
        file.path(), part.offset));
  check_packed_size(file, part, layout.encoding,
                    bytes + static_cast<std::uint64_t>(layout.skip_bytes));
  // A gzip file ends with its decoded size modulo 2^32 (of the last member, where several are
  // joined, so that it can only hint).
  std::byte size_bytes[4];
  if (!looks_gzip(head) || layout.samples_at_end || part.stored_bytes ||
      file.size() < part.offset + 18)
    return {};
  file.read(file.size() - 4, size_bytes);
  const auto stated = load_as<std::uint32_t>(size_bytes, 0, std::endian::little);
  const std::uint64_t needed = bytes + static_cast<std::uint64_t>(layout.skip_bytes);
  if (stated != 0 && stated != (needed & 0xffffffffU))
    return fmt::format(
        "{}: the gzip trailer speaks of {} decoded bytes where the header needs {} "
        "(modulo 2^32): the file may be truncated, or its sizes wrong",
        file.path(), stated, needed);
  return {};
}

void settle_packed(const ReadFile& file, const DataLayout::Part& part, const DataLayout& layout,
                   std::uint64_t bytes) {
  std::vector<std::byte> head(static_cast<std::size_t>(
      part.offset < file.size() ? std::min<std::uint64_t>(4, file.size() - part.offset) : 0));
  if (!head.empty()) file.read(part.offset, head);
  if (layout.encoding == DataEncoding::bzip2 && !looks_bzip2(head))
    throw FormatError(
        fmt::format("{}: the header announces samples compressed by bzip2 from byte {} on, but "
                    "there is no such "
                    "stream there: correct the encoding, the offset or the file",
                    file.path(), part.offset));
  check_packed_size(file, part, layout.encoding,
                    bytes + static_cast<std::uint64_t>(layout.skip_bytes));
}

}  // namespace

std::uint64_t checked_volume_bytes(Index3 size, SampleType type, const std::string& where) {
  std::uint64_t bytes = sample_bytes(type);
  for (int axis = 0; axis < 3; ++axis) {
    if (size[axis] <= 0)
      throw FormatError(
          fmt::format("{}: sizes must be positive, found {} {} {}", where, size.x, size.y, size.z));
    const auto side = static_cast<std::uint64_t>(size[axis]);
    if (bytes > max_volume_bytes / side)
      throw FormatError(
          fmt::format("{}: {} x {} x {} samples of {} are more than any file holds: "
                      "correct the sizes",
                      where, size.x, size.y, size.z, sample_type_name(type)));
    bytes *= side;
  }
  return bytes;
}

std::filesystem::path named_data_file(const InputSpec& spec, const std::string& name,
                                      const std::string& where) {
  const std::filesystem::path named = name, header = spec.path;
  const std::filesystem::path plain = named.lexically_normal();
  const bool outside = named.is_absolute() || (!plain.empty() && *plain.begin() == "..");
  if (outside && !spec.follow)
    throw FormatError(fmt::format(
        "{}: the header names {}, a data file {}: put the file beside the header and name it so, "
        "or "
        "allow it with input.follow = true (--follow)",
        where, name, named.is_absolute() ? "by an absolute path" : "outside the header's folder"));
  return header.parent_path() / named;
}

void require_input_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::is_regular_file(status)) return;
  throw InputError(fmt::format("{}: {}: correct the path", path.string(),
                               std::filesystem::exists(status) ? "not a regular file"
                               : status.type() == std::filesystem::file_type::not_found
                                   ? "no such file"
                                   : error.message()));
}

void require_inside(const Box3& box, const VolumeInfo& info) {
  if (box.empty() || !Box3{{}, info.geometry.size}.contains(box))
    throw std::logic_error(
        fmt::format("read of box [{},{}) x [{},{}) x [{},{}) outside a {} x {} x {} volume",
                    box.lo.x, box.hi.x, box.lo.y, box.hi.y, box.lo.z, box.hi.z,
                    info.geometry.size.x, info.geometry.size.y, info.geometry.size.z));
}

std::unique_ptr<SampleSource> open_layout(VolumeInfo info, DataLayout layout) {
  const std::uint64_t bytes =
      checked_volume_bytes(info.geometry.size, info.type, layout.named_by) / layout.parts.size();
  // Thousands of slice files say the same thing once.
  std::string note;
  std::size_t alike = 0;
  for (DataLayout::Part& part : layout.parts) {
    if (std::error_code ignored; !std::filesystem::is_regular_file(part.path, ignored))
      throw FormatError(fmt::format(
          "{}: the data file {} is {}: put it there or correct the name", layout.named_by,
          part.path.string(),
          std::filesystem::exists(part.path, ignored) ? "not a regular file" : "not there"));
    const ReadFile file(part.path);
    note_file(file, info.files);
    skip_lines(file, part);
    std::string said;
    if (layout.encoding == DataEncoding::raw) said = settle_raw(file, part, layout, bytes);
    if (layout.encoding == DataEncoding::deflated)
      said = settle_deflated(file, part, layout, bytes);
    if (layout.encoding == DataEncoding::bzip2 || layout.encoding == DataEncoding::byte_rle)
      settle_packed(file, part, layout, bytes);
    if (layout.encoding == DataEncoding::text)
      check_text_size(file, part, layout, bytes / sample_bytes(info.type));
    if (said.empty()) continue;
    if (note.empty())
      note = std::move(said);
    else
      ++alike;
  }
  if (alike > 0) note += fmt::format(" (and {} more files alike)", alike);
  if (!note.empty()) info.warnings.push_back(std::move(note));
  if (layout.encoding == DataEncoding::raw) return make_raw_source(std::move(info), layout);
  return make_stream_source(std::move(info), layout);
}

}  // namespace voxweld
