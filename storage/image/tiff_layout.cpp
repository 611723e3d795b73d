#include "storage/image/tiff_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "storage/support/error.h"

namespace voxweld {
namespace {

std::string compression_name(int compression) {
  switch (compression) {
    case COMPRESSION_NONE:
      return "none";
    case COMPRESSION_LZW:
      return "lzw";
    case COMPRESSION_ADOBE_DEFLATE:
    case COMPRESSION_DEFLATE:
      return "zip";
    case COMPRESSION_JPEG:
      return "jpeg";
    case COMPRESSION_PACKBITS:
      return "packbits";
    default:
      break;
  }
  const TIFFCodec* codec = TIFFFindCODEC(static_cast<std::uint16_t>(compression));
  return codec != nullptr ? codec->name : std::to_string(compression);
}

// At most this many bytes come of one stored byte.
double best_ratio(int compression) {
  switch (compression) {
    case COMPRESSION_NONE:
      return 1;
    case COMPRESSION_PACKBITS:
      return 64;
    case COMPRESSION_LZW:
      return 4096;
    case COMPRESSION_ADOBE_DEFLATE:
    case COMPRESSION_DEFLATE:
      return 1032;
    case COMPRESSION_JPEG:
      return 512;
    default:
      return 1 << 20;  // a page of one value may take some bytes
  }
}

void refuse_meanings(const TiffLayout& layout) {
  if (layout.compression == COMPRESSION_OJPEG)
    throw FormatError("JPEG of the old form (compression 6) is not supported");
  if (TIFFIsCODECConfigured(static_cast<std::uint16_t>(layout.compression)) == 0)
    throw FormatError(fmt::format("compression {} ({}) is not supported", layout.compression,
                                  compression_name(layout.compression)));
  const bool jpeg = layout.compression == COMPRESSION_JPEG;
  if (layout.photometric == PHOTOMETRIC_YCBCR && !jpeg)
    throw FormatError("colours as YCbCr are not supported beside JPEG");
  if (layout.photometric == PHOTOMETRIC_LOGL || layout.photometric == PHOTOMETRIC_LOGLUV)
    throw FormatError("colours as LogL or LogLuv are not supported");
}

void check_size(const TiffFile& file, const TiffLayout& layout, std::uint32_t planes) {
  const auto tiles = static_cast<std::uint64_t>(layout.across) * layout.down * planes;
  // A damaged count is known by the table that libtiff has for it.
  if (tiles > (layout.tiled ? TIFFNumberOfTiles(file.get()) : TIFFNumberOfStrips(file.get())))
    throw FormatError("its strips or tiles do not cover it");
  double stored = 0;
  for (std::uint64_t i = 0; i < tiles; ++i)
    stored +=
        static_cast<double>(TIFFGetStrileByteCount(file.get(), static_cast<std::uint32_t>(i)));
  stored = std::min(stored, static_cast<double>(file.bytes().size()));
  const double rows = layout.tiled
                          ? static_cast<double>(layout.tile_height) * layout.down
                          : static_cast<double>(file.tag<std::uint32_t>(TIFFTAG_IMAGELENGTH, 0));
  const double decoded = static_cast<double>(layout.tile_row_bytes) * rows * layout.across * planes;
  if (decoded > stored * best_ratio(layout.compression))
    throw FormatError(
        fmt::format("announces {:.0f} bytes of samples, but its {:.0f} stored bytes hold at most "
                    "{:.0f}: it is truncated or damaged",
                    decoded, stored, stored * best_ratio(layout.compression)));
}

std::uint32_t divided_up(std::uint32_t a, std::uint32_t b) {
  return a / b + (a % b != 0 ? 1 : 0);
}

void set_tiles(const TiffFile& file, TiffLayout& layout) {
  const auto width = file.tag<std::uint32_t>(TIFFTAG_IMAGEWIDTH, 0);
  const auto height = file.tag<std::uint32_t>(TIFFTAG_IMAGELENGTH, 0);
  layout.tiled = TIFFIsTiled(file.get()) != 0;
  layout.tile_width = width;
  layout.tile_height = std::min(file.tag<std::uint32_t>(TIFFTAG_ROWSPERSTRIP, height), height);
  if (layout.tiled) {
    layout.tile_width = file.tag<std::uint32_t>(TIFFTAG_TILEWIDTH, 0);
    layout.tile_height = file.tag<std::uint32_t>(TIFFTAG_TILELENGTH, 0);
  }
  constexpr std::uint32_t most = 0x7FFFFFFF;
  for (const std::uint32_t side : {width, height, layout.tile_width, layout.tile_height})
    if (side == 0 || side > most)
      throw FormatError(fmt::format("a side of {} pixels: expected 1 to {}", side, most));
  layout.across = divided_up(width, layout.tile_width);
  layout.down = divided_up(height, layout.tile_height);
  layout.tile_row_bytes =
      layout.tiled ? TIFFTileRowSize64(file.get()) : TIFFScanlineSize64(file.get());
  layout.tile_bytes = layout.tile_row_bytes * layout.tile_height;
  if (layout.tile_row_bytes == 0 || layout.tile_row_bytes > std::uint64_t{1} << 40)
    throw FormatError("its rows are too long to be read");
}

void refuse_depth(const TiffFile& file, std::uint32_t depth_tag) {
  if (const auto depth = file.tag<std::uint32_t>(depth_tag, 1); depth > 1)
    throw FormatError(
        fmt::format("holds a volumetric image of depth {}, which is not supported", depth));
}

std::vector<std::string> channel_names(const TiffFile& file, const TiffLayout& layout) {
  std::vector<std::string> names;
  const auto add = [&](std::initializer_list<const char*> more) {
    names.insert(names.end(), more.begin(), more.end());
  };
  if (layout.photometric == PHOTOMETRIC_RGB || layout.photometric == PHOTOMETRIC_YCBCR)
    add({"red", "green", "blue"});  // YCbCr is decoded to them
  else if (layout.photometric == PHOTOMETRIC_SEPARATED)
    add({"cyan", "magenta", "yellow", "black"});
  else if (layout.photometric == PHOTOMETRIC_CIELAB)
    add({"L", "a", "b"});
  else
    add({"grey"});
  std::uint16_t extra = 0;
  std::uint16_t* kinds = nullptr;
  if (TIFFGetField(file.get(), TIFFTAG_EXTRASAMPLES, &extra, &kinds) == 1)
    for (std::uint16_t i = 0; i < extra; ++i)
      names.emplace_back(kinds[i] == EXTRASAMPLE_UNSPECIFIED ? "" : "alpha");
  return names;
}

// Where the samples begin, if all strips lie one behind the other and need no more than a turn of
// their bytes.
std::optional<std::uint64_t> raw_offset(const TiffFile& file, const TiffLayout& layout) {
  const TiffSampleTags& tags = layout.coding.tags;
  const bool as_read = tags.bits == static_cast<int>(8 * sample_bytes(layout.coding.type));
  if (!layout.direct || layout.reversed_bits || layout.coding.white_is_zero || !as_read)
    return std::nullopt;
  const std::uint64_t first = TIFFGetStrileOffset(file.get(), 0);
  for (std::uint32_t i = 1; i < layout.down; ++i)
    if (TIFFGetStrileOffset(file.get(), i) != first + i * layout.tile_bytes) return std::nullopt;
  return first;
}

const char* resolution_unit(int tag) {
  if (tag == RESUNIT_INCH) return "in";
  if (tag == RESUNIT_CENTIMETER) return "cm";
  return tag == RESUNIT_NONE ? "none" : "";
}

}  // namespace

TiffLayout tiff_layout(const TiffFile& file) {
  TiffLayout layout;
  TiffSampleTags& tags = layout.coding.tags;
  const int channels = file.tag<std::uint16_t>(TIFFTAG_SAMPLESPERPIXEL, 1);
  tags.bits = file.tag<std::uint16_t>(TIFFTAG_BITSPERSAMPLE, 1);
  tags.format = file.tag<std::uint16_t>(TIFFTAG_SAMPLEFORMAT, 1);
  layout.compression = file.tag<std::uint16_t>(TIFFTAG_COMPRESSION, 1);
  layout.photometric = file.tag<std::uint16_t>(
      TIFFTAG_PHOTOMETRIC, channels < 3 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
  refuse_meanings(layout);
  if (layout.photometric == PHOTOMETRIC_YCBCR)
    TIFFSetField(file.get(), TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
  refuse_depth(file, TIFFTAG_IMAGEDEPTH);
  const std::optional<SampleType> type = tiff_sample_type(tags);
  if (!type)
    throw FormatError(fmt::format("samples of {} bits of {} are not supported", tags.bits,
                                  tags.format == 3  ? "floating point"
                                  : tags.format > 4 ? "complex numbers"
                                                    : "integers"));
  layout.coding.type = *type;
  layout.coding.white_is_zero = layout.photometric == PHOTOMETRIC_MINISWHITE;
  layout.planar = channels > 1 && file.tag<std::uint16_t>(TIFFTAG_PLANARCONFIG, 1) == 2;
  layout.reversed_bits = file.tag<std::uint16_t>(TIFFTAG_FILLORDER, 1) == FILLORDER_LSB2MSB;
  set_tiles(file, layout);
  if (layout.tiled) refuse_depth(file, TIFFTAG_TILEDEPTH);
  layout.direct = layout.compression == COMPRESSION_NONE && !layout.tiled;
  check_size(file, layout, layout.planar ? static_cast<std::uint32_t>(channels) : 1);
  return layout;
}

ImagePage tiff_page_facts(const TiffFile& file, const TiffLayout& layout) {
  ImagePage page;
  page.format = "tiff";
  page.width = file.tag<std::uint32_t>(TIFFTAG_IMAGEWIDTH, 0);
  page.height = file.tag<std::uint32_t>(TIFFTAG_IMAGELENGTH, 0);
  page.channels = file.tag<std::uint16_t>(TIFFTAG_SAMPLESPERPIXEL, 1);
  page.channel_names = channel_names(file, layout);
  page.type = layout.coding.type;
  page.stored_bits = layout.coding.tags.bits;
  page.compression = compression_name(layout.compression);
  page.palette = layout.photometric == PHOTOMETRIC_PALETTE;
  page.white_is_zero = layout.coding.white_is_zero;
  page.orientation = file.tag<std::uint16_t>(TIFFTAG_ORIENTATION, 1);
  if (layout.tiled) {
    page.tile_width = layout.tile_width;
    page.tile_height = layout.tile_height;
  }
  page.strip_rows = std::min<std::int64_t>(layout.tile_height, page.height);
  page.x_resolution = static_cast<double>(file.tag<float>(TIFFTAG_XRESOLUTION, 0));
  page.y_resolution = static_cast<double>(file.tag<float>(TIFFTAG_YRESOLUTION, 0));
  page.resolution_unit = resolution_unit(file.tag<std::uint16_t>(TIFFTAG_RESOLUTIONUNIT, 0));
  char* text = nullptr;
  if (TIFFGetField(file.get(), TIFFTAG_IMAGEDESCRIPTION, &text) == 1 && text != nullptr)
    page.description = text;
  if (page.channels == 1) page.raw_offset = raw_offset(file, layout);
  page.big_endian =
      (TIFFIsByteSwapped(file.get()) != 0) == (std::endian::native == std::endian::little);
  return page;
}

}  // namespace voxweld
