#include "storage/image/tiff_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>

#include "storage/image/tiff_layout.h"
#include "storage/support/byte_order.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// Of an uncompressed strip so much is read at once.
constexpr std::uint64_t direct_bytes = std::uint64_t{1} << 20;

std::int64_t direct_rows(const TiffLayout& layout) {
  return std::clamp<std::int64_t>(static_cast<std::int64_t>(direct_bytes / layout.tile_row_bytes),
                                  1, layout.tile_height);
}

// Codecs that fill up what is missing and only warn.
bool warnings_count(int compression) {
  return compression == COMPRESSION_JPEG || compression == COMPRESSION_CCITTRLE ||
         compression == COMPRESSION_CCITTRLEW || compression == COMPRESSION_CCITTFAX3 ||
         compression == COMPRESSION_CCITTFAX4;
}

std::uint64_t decode_bytes(const ImagePage& page, const TiffLayout& layout) {
  if (layout.direct) return layout.tile_row_bytes * static_cast<std::uint64_t>(direct_rows(layout));
  // A strip and what is stored of it, or a row of tiles and what is stored of one.
  const std::uint64_t rows =
      layout.tiled ? layout.tile_height : static_cast<std::uint64_t>(page.strip_rows);
  return layout.tile_row_bytes * rows * (layout.across + std::uint64_t{1});
}

bool is_float(const TiffLayout& layout) {
  return layout.coding.type == SampleType::f32 || layout.coding.type == SampleType::f64;
}

void swap_triples(std::span<std::byte> bytes) {
  TIFFSwabArrayOfTriples(reinterpret_cast<std::uint8_t*>(bytes.data()),
                         static_cast<tmsize_t>(bytes.size() / 3));
}

std::string level_problem(int level, int levels) {
  return fmt::format("has no level {}: its levels are 0 to {}", level, levels - 1);
}

}  // namespace

std::unique_ptr<TiffReader> TiffReader::open(const std::string& path, int level,
                                             std::string& error) {
  TiffDirectories directories;
  if (!list_tiff_directories(ReadFile(path), directories, error)) {
    if (error.empty()) error = "not a TIFF file";
    return nullptr;
  }
  std::unique_ptr<TiffReader> reader(new TiffReader(path, level, std::move(directories)));
  reader->select(0);
  return reader;
}

void TiffReader::select(int page) {
  if (page == selected_) return;
  selected_ = -1;
  band_ = {};
  file_.go_to(directories_.offsets.at(static_cast<std::size_t>(page)));
  std::uint16_t parts = 0;
  std::uint64_t* offsets = nullptr;
  int levels = 1;
  if (TIFFGetField(file_.get(), TIFFTAG_SUBIFD, &parts, &offsets) == 1) levels += parts;
  if (level_ >= levels) throw FormatError(level_problem(level_, levels));
  if (level_ > 0) file_.go_to(offsets[level_ - 1]);
  layout_ = tiff_layout(file_);
  page_ = tiff_page_facts(file_, layout_);
  page_.levels = levels;
  page_.decode_bytes = decode_bytes(page_, layout_);
  selected_ = page;
}

bool TiffReader::describe(int page, ImagePage& out, std::string& error) try {
  select(page);
  out = page_;
  return true;
} catch (const std::exception& failure) {
  error = failure.what();
  return false;
}

// Rows of an uncompressed strip, from y on.
void TiffReader::load_direct(std::uint32_t plane, std::int64_t y) {
  const std::int64_t strip = y / layout_.tile_height, top = strip * layout_.tile_height;
  const std::int64_t rows = direct_rows(layout_);
  const std::int64_t begin = top + (y - top) / rows * rows;
  const std::int64_t end =
      std::min({begin + rows, top + std::int64_t{layout_.tile_height}, page_.height});
  const auto strile = static_cast<std::uint32_t>(strip) + plane * layout_.down;
  const std::uint64_t skip = static_cast<std::uint64_t>(begin - top) * layout_.tile_row_bytes;
  const std::uint64_t size = static_cast<std::uint64_t>(end - begin) * layout_.tile_row_bytes;
  const std::uint64_t stored = TIFFGetStrileByteCount(file_.get(), strile);
  if (skip + size > stored)
    throw FormatError(
        fmt::format("strip {} has {} bytes, {} are needed", strile, stored, skip + size));
  const std::uint64_t offset = TIFFGetStrileOffset(file_.get(), strile);
  if (offset > file_.bytes().size()) throw FormatError("a strip begins behind the file's end");
  band_.bytes.resize(static_cast<std::size_t>(size));
  file_.bytes().read(offset + skip, band_.bytes);
  if (layout_.reversed_bits)
    TIFFReverseBits(reinterpret_cast<std::uint8_t*>(band_.bytes.data()),
                    static_cast<tmsize_t>(size));
  const std::endian order = page_.big_endian ? std::endian::big : std::endian::little;
  const auto width = static_cast<std::size_t>(layout_.coding.tags.bits / 8);
  if (layout_.coding.tags.bits == 24 && is_float(layout_) && order != std::endian::native)
    swap_triples(band_.bytes);
  else if (layout_.coding.tags.bits % 16 == 0)
    to_native(band_.bytes.data(), static_cast<std::size_t>(size / width), width, order);
  band_.begin = begin;
  band_.end = end;
}

// The strip or the row of tiles that holds row y.
void TiffReader::load_band(std::uint32_t plane, std::int64_t y) {
  if (band_.plane == plane && y >= band_.begin && y < band_.end) return;
  band_.begin = band_.end = 0;  // of no use when decoding fails half-way
  band_.plane = plane;
  if (layout_.direct) return load_direct(plane, y);
  const std::int64_t index = y / layout_.tile_height, begin = index * layout_.tile_height;
  const std::int64_t end = std::min(begin + layout_.tile_height, page_.height);
  const std::uint64_t size = layout_.tiled
                                 ? layout_.tile_bytes
                                 : layout_.tile_row_bytes * static_cast<std::uint64_t>(end - begin);
  band_.bytes.resize(static_cast<std::size_t>(size * layout_.across));
  const auto first = (plane * layout_.down + static_cast<std::uint32_t>(index)) * layout_.across;
  for (std::uint32_t i = 0; i < layout_.across; ++i)
    file_.decode(first + i, layout_.tiled, warnings_count(layout_.compression),
                 std::span(band_.bytes)
                     .subspan(static_cast<std::size_t>(i * size), static_cast<std::size_t>(size)));
  // libtiff has turned them; integers of 24 bits are a stream.
  if (layout_.coding.tags.bits == 24 && !is_float(layout_) && TIFFIsByteSwapped(file_.get()) != 0)
    swap_triples(band_.bytes);
  band_.begin = begin;
  band_.end = end;
}

// One channel of row y, which is decoded, to its places in `out`.
void TiffReader::copy_row(const ImageRows& rows, std::uint32_t channel, std::int64_t y,
                          std::byte* out) const {
  const auto channels = static_cast<std::size_t>(page_.channels);
  const std::size_t out_step = rows.channel ? 1 : channels;
  const std::size_t width = sample_bytes(page_.type);
  const auto pixels = static_cast<std::size_t>(page_.width);
  const std::uint64_t tile_bytes =
      layout_.tiled ? layout_.tile_bytes : static_cast<std::uint64_t>(band_.bytes.size());
  const std::uint64_t row = static_cast<std::uint64_t>(y - band_.begin) * layout_.tile_row_bytes;
  for (std::size_t x = 0, tile = 0; x < pixels; x += layout_.tile_width, ++tile) {
    TiffRun run{.first = layout_.planar ? 0 : channel,
                .step = layout_.planar ? 1 : channels,
                .count = std::min<std::size_t>(layout_.tile_width, pixels - x)};
    convert_tiff_run(layout_.coding, band_.bytes.data() + tile * tile_bytes + row, run,
                     out + (x * out_step + (rows.channel ? 0 : channel)) * width, out_step);
  }
}

bool TiffReader::read_rows(const ImageRows& rows, std::byte* out, std::string& error) try {
  if (rows.page >= page_count()) throw FormatError("the page is not there any more");
  select(rows.page);
  const auto channels = static_cast<std::uint32_t>(page_.channels);
  const std::uint32_t first = rows.channel ? static_cast<std::uint32_t>(*rows.channel) : 0;
  const std::uint32_t last = rows.channel ? first + 1 : channels;
  const std::size_t row_bytes =
      static_cast<std::size_t>(page_.width) * (last - first) * sample_bytes(page_.type);
  // Planes one behind the other, so that the strips of each are decoded once.
  for (std::uint32_t channel = first; channel < last; ++channel)
    for (std::int64_t y = rows.y0; y < rows.y1; ++y) {
      load_band(layout_.planar ? channel : 0, y);
      copy_row(rows, channel, y, out + static_cast<std::size_t>(y - rows.y0) * row_bytes);
    }
  return true;
} catch (const std::exception& failure) {
  error = failure.what();
  return false;
}

}  // namespace voxweld
