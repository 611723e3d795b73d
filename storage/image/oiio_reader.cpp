#include "storage/image/oiio_reader.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <optional>

#include "storage/image/format_checks.h"

namespace voxweld {
namespace {

// By position in enum SampleType.
constexpr OIIO::TypeDesc::BASETYPE oiio_types[] = {
    OIIO::TypeDesc::UINT8,  OIIO::TypeDesc::INT8,  OIIO::TypeDesc::UINT16, OIIO::TypeDesc::INT16,
    OIIO::TypeDesc::UINT32, OIIO::TypeDesc::INT32, OIIO::TypeDesc::UINT64, OIIO::TypeDesc::INT64,
    OIIO::TypeDesc::FLOAT,  OIIO::TypeDesc::DOUBLE};

OIIO::TypeDesc oiio_type(SampleType type) {
  return oiio_types[static_cast<std::size_t>(type)];
}

std::optional<SampleType> sample_type(const OIIO::TypeDesc& format) {
  if (format.basetype == OIIO::TypeDesc::HALF) return SampleType::f32;
  const auto found = std::ranges::find(oiio_types, format.basetype);
  if (found == std::end(oiio_types)) return std::nullopt;
  return static_cast<SampleType>(found - oiio_types);
}

std::uint64_t row_bytes(const ImagePage& page) {
  return static_cast<std::uint64_t>(page.width) * static_cast<std::uint64_t>(page.channels) *
         sample_bytes(page.type);
}

void describe_layout(const OIIO::ImageSpec& spec, ImagePage& page) {
  page.compression = spec.get_string_attribute("compression", "unknown");
  if (spec.tile_width > 0) {
    page.tile_width = spec.tile_width;
    page.tile_height = spec.tile_height;
  }
  // Without tiles a page is decoded as a whole at worst (interlaced PNG).
  page.strip_rows = page.tile_height > 0 ? std::min(page.tile_height, page.height) : page.height;
  // Held twice, as stored and as decoded; so is a tile row, as tiles and rows.
  page.decode_bytes = 2 * row_bytes(page) * static_cast<std::uint64_t>(page.strip_rows);
}

bool is_integer(SampleType type) {
  return type != SampleType::f32 && type != SampleType::f64;
}

// Bits that OpenImageIO stretched the samples by and that `restore` takes back.
int stretched_bits(const ImagePage& page) {
  const bool known = page.format == "png";
  const bool is_unsigned =
      page.type == SampleType::u8 || page.type == SampleType::u16 || page.type == SampleType::u32;
  return known && is_unsigned ? static_cast<int>(8 * sample_bytes(page.type)) - page.stored_bits
                              : 0;
}

void describe_meaning(const OIIO::ImageSpec& spec, const std::string& path, ImagePage& page) {
  const int type_bits = static_cast<int>(8 * sample_bytes(page.type));
  page.stored_bits =
      std::clamp(spec.get_int_attribute("oiio:BitsPerSample", type_bits), 1, type_bits);
  if (page.format == "png") {
    const PngFacts facts = png_facts(path);
    page.stored_bits = std::clamp(facts.bits, 1, type_bits);
    page.palette = facts.palette;
  }
  page.rescaled =
      is_integer(page.type) && page.stored_bits < type_bits && stretched_bits(page) == 0;
  page.channel_names = spec.channelnames;
  page.orientation = spec.get_int_attribute("Orientation", 1);
  page.x_resolution = static_cast<double>(spec.get_float_attribute("XResolution", 0));
  page.y_resolution = static_cast<double>(spec.get_float_attribute("YResolution", 0));
  page.resolution_unit = spec.get_string_attribute("ResolutionUnit", "");
  page.description = spec.get_string_attribute("ImageDescription", "");
}

// Brings what OpenImageIO makes of odd bit depths back to the values of the file. It stretches n
// bits to the type's range as floor(v (2^t - 1) / (2^n - 1)), whose top n bits are v.
template <class T>
void restore_values(int shift, T* samples, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) samples[i] = static_cast<T>(samples[i] >> shift);
}

void restore(const ImagePage& page, std::byte* data, std::size_t count) {
  const int shift = stretched_bits(page);
  if (shift == 0) return;
  if (page.type == SampleType::u8)
    restore_values(shift, reinterpret_cast<std::uint8_t*>(data), count);
  if (page.type == SampleType::u16)
    restore_values(shift, reinterpret_cast<std::uint16_t*>(data), count);
}

OIIO::ImageSpec open_config() {
  OIIO::ImageSpec config;
  config.attribute("oiio:RawColor", 1);           // no colour conversion
  config.attribute("oiio:UnassociatedAlpha", 1);  // no multiplication by alpha
  return config;
}

}  // namespace

std::unique_ptr<OiioReader> OiioReader::open(const std::string& path, std::string& error) {
  const OIIO::ImageSpec config = open_config();
  auto input = OIIO::ImageInput::open(path, &config);
  if (!input) {
    error = OIIO::geterror();
    if (error.empty()) error = "not an image of a known format";
    return nullptr;
  }
  error = format_objection(input->format_name(), path);
  if (!error.empty()) return nullptr;
  return std::unique_ptr<OiioReader>(new OiioReader(std::move(input), path));
}

int OiioReader::page_count() {
  int count = 0;
  while (input_->seek_subimage(count, 0)) ++count;
  selected_ = -1;
  static_cast<void>(input_->geterror());  // no more than "no such page"
  return count;
}

bool OiioReader::select(int page, std::string& error) {
  if (page == selected_) return true;
  selected_ = -1;
  tile_row_index_ = -1;
  if (!input_->seek_subimage(page, 0)) {
    error = input_->geterror();
    if (error.empty()) error = "the page is not there any more";
    return false;
  }
  const OIIO::ImageSpec& spec = input_->spec();
  const std::optional<SampleType> type = sample_type(spec.format);
  if (!type) {
    error = std::string("samples of type ") + spec.format.c_str() + " are not supported";
    return false;
  }
  if (spec.depth > 1) {
    error = "holds a volumetric image of depth " + std::to_string(spec.depth) +
            ", which is not supported";
    return false;
  }
  page_ = ImagePage{};
  page_.format = input_->format_name();
  page_.width = spec.width;
  page_.height = spec.height;
  page_.channels = spec.nchannels;
  page_.type = *type;
  describe_layout(spec, page_);
  describe_meaning(spec, path_, page_);
  selected_ = page;
  return true;
}

bool OiioReader::describe(int page, ImagePage& out, std::string& error) try {
  if (!select(page, error)) return false;
  out = page_;
  return true;
} catch (const std::exception& failure) {
  error = failure.what();
  return false;
}

bool OiioReader::read_rows(const ImageRows& rows, std::byte* out, std::string& error) try {
  static_cast<void>(input_->geterror());  // what earlier warnings left there
  if (!select(rows.page, error)) return false;
  const OIIO::ImageSpec& spec = input_->spec();
  const int first = rows.channel.value_or(0);
  const int last = rows.channel ? first + 1 : spec.nchannels;
  const bool done = page_.tile_height > 0
                        ? read_tiled(rows, out)
                        : input_->read_scanlines(input_->current_subimage(), 0,
                                                 spec.y + static_cast<int>(rows.y0),
                                                 spec.y + static_cast<int>(rows.y1), spec.z, first,
                                                 last, oiio_type(page_.type), out);
  if (!done) {
    error = input_->geterror();
    if (error.empty()) error = "no reason given";
    return false;
  }
  if (page_.tile_height == 0)
    restore(page_, out,
            static_cast<std::size_t>((rows.y1 - rows.y0) * page_.width) *
                static_cast<std::size_t>(last - first));
  return true;
} catch (const std::exception& failure) {
  error = failure.what();
  return false;
}

bool OiioReader::read_tiled(const ImageRows& rows, std::byte* out) {
  const std::uint64_t row = row_bytes(page_);
  const std::size_t width = sample_bytes(page_.type);
  const std::size_t pixel = width * static_cast<std::size_t>(page_.channels);
  for (std::int64_t y = rows.y0; y < rows.y1; ++y) {
    const std::int64_t index = y / page_.tile_height;
    if (!load_tile_row(index)) return false;
    const std::byte* from =
        tile_row_.data() + static_cast<std::uint64_t>(y - index * page_.tile_height) * row;
    if (!rows.channel) {
      std::memcpy(out, from, row);
      out += row;
      continue;
    }
    from += static_cast<std::size_t>(*rows.channel) * width;
    for (std::int64_t x = 0; x < page_.width; ++x, from += pixel, out += width)
      std::memcpy(out, from, width);
  }
  return true;
}

bool OiioReader::load_tile_row(std::int64_t index) {
  if (index == tile_row_index_) return true;
  const OIIO::ImageSpec& spec = input_->spec();
  const std::int64_t begin = index * page_.tile_height;
  const std::int64_t end = std::min(begin + page_.tile_height, page_.height);
  tile_row_index_ = -1;
  tile_row_.resize(row_bytes(page_) * static_cast<std::uint64_t>(end - begin));
  if (!input_->read_tiles(input_->current_subimage(), 0, spec.x, spec.x + spec.width,
                          spec.y + static_cast<int>(begin), spec.y + static_cast<int>(end), spec.z,
                          spec.z + 1, 0, spec.nchannels, oiio_type(page_.type), tile_row_.data()))
    return false;
  restore(page_, tile_row_.data(), tile_row_.size() / sample_bytes(page_.type));
  tile_row_index_ = index;
  return true;
}

}  // namespace voxweld
