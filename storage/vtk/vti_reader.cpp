#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "storage/support/byte_order.h"
#include "storage/support/error.h"
#include "storage/types/chunked_access.h"
#include "storage/volumes/data_layout.h"
#include "storage/vtk/readers.h"
#include "storage/vtk/vti_header.h"

namespace voxweld {
namespace {

// What is known of the array that is read.
struct VtiData {
  std::shared_ptr<const ReadFile> file;
  const VtiHeader& header;
  const VtiArray& array;
  std::uint64_t bytes = 0;  // of its samples
  std::string where;        // for messages
};

bool in_base64(const VtiData& data) {
  return data.array.format == VtiFormat::binary || data.header.appended_is_base64;
}

std::unique_ptr<ByteRun> stored_run(const VtiData& data, std::uint64_t from) {
  const FileSpan span{data.file, std::min(from, data.array.end), data.array.end};
  return in_base64(data) ? base64_run(span) : plain_run(span);
}

// Bytes that `bytes` take as they are stored, where they are encoded by themselves.
std::uint64_t stored_bytes(const VtiData& data, std::uint64_t bytes) {
  return in_base64(data) ? (bytes + 2) / 3 * 4 : bytes;
}

[[noreturn]] void fail_length(const VtiData& data, std::uint64_t found) {
  throw FormatError(fmt::format(
      "{}: {} bytes of samples are announced by the extent, {} by the length in front of the data: "
      "damaged, or another byte_order or header_type than the file says",
      data.where, data.bytes, found));
}

// Some writers encode the length by itself, so that padding stands between it and the samples.
bool length_is_apart(const VtiData& data) {
  const std::uint64_t last = data.array.begin + stored_bytes(data, data.header.words.bytes) - 1;
  std::byte digit[1];
  data.file->read(last, digit);
  return digit[0] == std::byte{'='};
}

// Uncompressed: a length in bytes, then the samples.
std::unique_ptr<SampleSource> open_uncompressed(VolumeInfo info, const VtiData& data) {
  const WordForm words = data.header.words;
  auto run = stored_run(data, data.array.begin);
  std::byte head[8];
  run->read(0, std::span(head).first(words.bytes));
  const std::uint64_t length = words.bytes == 8 ? load_as<std::uint64_t>(head, 0, words.order)
                                                : load_as<std::uint32_t>(head, 0, words.order);
  // Lengths of 32 bits wrap in files of some writers, whose samples are there all the same.
  const std::uint64_t mask = words.bytes == 8 ? ~std::uint64_t{0} : 0xffffffffU;
  if (length != (data.bytes & mask)) fail_length(data, length);
  if (run->most_bytes() < words.bytes || run->most_bytes() - words.bytes < data.bytes)
    throw FormatError(
        fmt::format("{}: truncated: {} bytes of samples are announced from byte {} on, the file "
                    "has {}: get a complete copy or correct the extent",
                    data.where, data.bytes, data.array.begin, data.file->size()));
  if (in_base64(data)) {
    std::uint64_t skip = words.bytes;
    if (length_is_apart(data)) {
      run = stored_run(data, data.array.begin + stored_bytes(data, words.bytes));
      skip = 0;
    }
    info.access = Access::box;
    info.row_major = true;
    info.largest_decode = std::uint64_t{1} << 17;
    return run_source(std::move(info), {std::move(run), skip, words.order});
  }
  DataLayout layout;
  layout.parts = {{.path = data.file->path(),
                   .offset = data.array.begin + words.bytes,
                   .stored_bytes = data.bytes}};
  layout.byte_order = words.order;
  layout.named_by = data.where;
  return open_layout(std::move(info), std::move(layout));
}

std::unique_ptr<SampleSource> open_compressed(VolumeInfo info, const VtiData& data) {
  const WordForm words = data.header.words;
  const BlockCodec codec = *data.header.codec;
  BlockTable table =
      read_block_table(*stored_run(data, data.array.begin), words, data.bytes, codec, data.where);
  const std::uint64_t table_bytes = stored_bytes(data, block_table_bytes(table, words));
  auto compressed = stored_run(data, data.array.begin + table_bytes);
  if (compressed->most_bytes() < table.starts.back())
    throw FormatError(
        fmt::format("{}: truncated: {} compressed bytes are announced, the file has "
                    "{}: get a complete copy",
                    data.where, table.starts.back(), compressed->most_bytes()));
  // A block is a run of bytes: some rows, or some slices.
  const Index3 size = info.geometry.size;
  const auto samples = static_cast<std::int64_t>(table.block_bytes / sample_bytes(info.type)) + 1;
  info.chunk = {size.x, std::min(size.y, samples / size.x + 1),
                std::min(size.z, samples / (size.x * size.y) + 1)};
  info.access = chunked_access(size, info.chunk);
  OpenedBlocks blocks = open_blocks(std::move(compressed), std::move(table), codec, data.where);
  info.largest_decode = blocks.memory + (std::uint64_t{1} << 17);
  return run_source(std::move(info), {std::move(blocks.run), 0, words.order});
}

std::unique_ptr<SampleSource> open_text(VolumeInfo info, const VtiData& data) {
  DataLayout layout;
  layout.parts = {{.path = data.file->path(),
                   .offset = data.array.begin,
                   .stored_bytes = data.array.end - data.array.begin}};
  layout.encoding = DataEncoding::text;
  layout.named_by = data.where;
  return open_layout(std::move(info), std::move(layout));
}

std::unique_ptr<SampleSource> open_vti(const InputSpec& spec) {
  require_input_file(spec.path);
  const auto file = std::make_shared<const ReadFile>(spec.path);
  VtiHeader header = read_vti_header(*file);
  VolumeInfo info;
  info.format = "vti";
  info.files.push_back({file->path(), file->state()});
  info.warnings = std::move(header.warnings);
  std::vector<VtkArray> arrays;
  for (const VtiArray& array : header.arrays) arrays.push_back(array.array);
  const VtiArray& array =
      header
          .arrays[choose_vtk_array(arrays, header.marked_points, header.marked_cells, spec, info)];
  const std::string where = fmt::format("{}: array '{}'", file->path(), array.array.name);
  place_vtk_samples(header.lattice, array.array, file->path(), info);
  info.type = *array.array.type;
  const VtiData data{file, header, array,
                     checked_volume_bytes(info.geometry.size, info.type, where), where};
  if (array.format == VtiFormat::ascii) return open_text(std::move(info), data);
  if (header.codec) return open_compressed(std::move(info), data);
  return open_uncompressed(std::move(info), data);
}

Match test_vti(const InputProbe& probe) {
  const std::string_view head(reinterpret_cast<const char*>(probe.head.data()), probe.head.size());
  const std::size_t root = head.find("<VTKFile");
  if (root != std::string_view::npos &&
      head.find_first_not_of(" \t\r\n\xef\xbb\xbf") == head.find('<'))
    return Match::contents;
  const bool named = probe.extension == ".vti" || probe.extension == ".pvti";
  return probe.is_file && named ? Match::extension : Match::none;
}

}  // namespace

VolumeReader vti_reader() {
  return {.name = "vti",
          .files = ".vti",
          .test = test_vti,
          .open = open_vti,
          .selects = {Selector::dataset}};
}

}  // namespace voxweld
