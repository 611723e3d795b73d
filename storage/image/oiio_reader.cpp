#include "storage/image/oiio_reader.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <limits>
#include <optional>

#include "storage/image/format_checks.h"

namespace voxweld {
namespace {

namespace tiff {
constexpr int compression_none = 1;
constexpr int white_is_zero = 0;
constexpr int palette = 3;
}  // namespace tiff

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
  const bool is_tiff = page.format == "tiff";
  const int compression = spec.get_int_attribute("tiff:Compression", 0);
  page.compression = spec.get_string_attribute("compression", "unknown");
  if (spec.tile_width > 0) {
    page.tile_width = spec.tile_width;
    page.tile_height = spec.tile_height;
  }
  // A tag larger than the image means one strip; formats without the tag decode as a whole at worst
  // (interlaced PNG).
  const int tagged = spec.get_int_attribute("tiff:RowsPerStrip", 0);
  page.strip_rows = page.tile_height > 0 ? std::min(page.tile_height, page.height)
                    : tagged > 0         ? std::min<std::int64_t>(tagged, page.height)
                                         : page.height;
  // Compressed strips are held twice, as stored and as decoded; so is a tile row, as tiles and
  // rows.
  const std::uint64_t strip = row_bytes(page) * static_cast<std::uint64_t>(page.strip_rows);
  const bool once = is_tiff && compression == tiff::compression_none && page.tile_height == 0;
  page.decode_bytes = once ? strip : 2 * strip;
}

bool is_integer(SampleType type) {
  return type != SampleType::f32 && type != SampleType::f64;
}

// Bits that OpenImageIO stretched the samples by and that `restore` takes back.
int stretched_bits(const ImagePage& page) {
  const bool known = page.format == "tiff" || page.format == "png";
  const bool is_unsigned =
      page.type == SampleType::u8 || page.type == SampleType::u16 || page.type == SampleType::u32;
  return known && is_unsigned ? static_cast<int>(8 * sample_bytes(page.type)) - page.stored_bits
                              : 0;
}

void describe_meaning(const OIIO::ImageSpec& spec, const std::string& path, ImagePage& page) {
  const int type_bits = static_cast<int>(8 * sample_bytes(page.type));
  const int photometric = spec.get_int_attribute("tiff:PhotometricInterpretation", -1);
  page.stored_bits =
      std::clamp(spec.get_int_attribute("oiio:BitsPerSample", type_bits), 1, type_bits);
  page.palette = photometric == tiff::palette;
  if (page.format == "png") {
    const PngFacts facts = png_facts(path);
    page.stored_bits = std::clamp(facts.bits, 1, type_bits);
    page.palette = facts.palette;
  }
  page.rescaled =
      is_integer(page.type) && page.stored_bits < type_bits && stretched_bits(page) == 0;
  page.white_is_zero = photometric == tiff::white_is_zero;
  page.orientation = spec.get_int_attribute("Orientation", 1);
  page.x_resolution = static_cast<double>(spec.get_float_attribute("XResolution", 0));
  page.y_resolution = static_cast<double>(spec.get_float_attribute("YResolution", 0));
  page.resolution_unit = spec.get_string_attribute("ResolutionUnit", "");
  page.description = spec.get_string_attribute("ImageDescription", "");
}

// Brings what OpenImageIO makes of odd bit depths back to the values of the file, seen as
// brightness. It stretches n bits to the type's range as floor(v (2^t - 1) / (2^n - 1)), whose top
// n bits are v, and turns white-is-zero images round only where they are read as uint8.
template <class T>
void restore_values(const ImagePage& page, T* samples, std::size_t count) {
  const int shift = stretched_bits(page);
  const bool invert = page.white_is_zero && sizeof(T) > 1;
  const bool inverted = page.white_is_zero && sizeof(T) == 1;
  constexpr T top = std::numeric_limits<T>::max();
  const T mask = static_cast<T>(top >> shift);
  for (std::size_t i = 0; i < count; ++i) {
    // The stretched value is undone before the turn: floor does not commute with it.
    const T stretched = inverted ? static_cast<T>(top - samples[i]) : samples[i];
    const T stored = static_cast<T>(stretched >> shift);
    samples[i] = invert || inverted ? static_cast<T>(mask - stored) : stored;
  }
}

void restore(const ImagePage& page, std::byte* data, std::size_t count) {
  if (stretched_bits(page) == 0 && !page.white_is_zero) return;
  if (page.type == SampleType::u8)
    restore_values(page, reinterpret_cast<std::uint8_t*>(data), count);
  if (page.type == SampleType::u16)
    restore_values(page, reinterpret_cast<std::uint16_t*>(data), count);
  if (page.type == SampleType::u32)
    restore_values(page, reinterpret_cast<std::uint32_t*>(data), count);
}

OIIO::ImageSpec open_config() {
  OIIO::ImageSpec config;
  config.attribute("oiio:RawColor", 1);           // no colour conversion
  config.attribute("oiio:UnassociatedAlpha", 1);  // no multiplication by alpha
  return config;
}

}  // namespace

std::unique_ptr<OiioReader> OiioReader::open(const std::string& path, std::string& error) {
  TiffDirectories directories;
  if (list_tiff_directories(ReadFile(path), directories, error)) {
    std::unique_ptr<OiioReader> reader(new OiioReader(nullptr, path));
    reader->directories_ = std::move(directories);
    return reader->open_tiff(error) ? std::move(reader) : nullptr;
  }
  if (!error.empty()) return nullptr;
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

bool OiioReader::open_tiff(std::string& error) {
  view_ = std::make_unique<TiffPageView>(path_, directories_);
  input_ = OIIO::ImageInput::create("tiff");
  if (!input_) error = OIIO::geterror();
  return input_ != nullptr && seek(0, error);
}

// Makes a page the one `input_` reads. False with an empty error: there is no such page.
bool OiioReader::seek(int page, std::string& error) {
  if (page < 0) return false;
  if (!view_) return input_->seek_subimage(page, 0);
  if (static_cast<std::size_t>(page) >= directories_.offsets.size()) return false;
  input_->close();
  view_->choose(directories_.offsets[static_cast<std::size_t>(page)]);
  input_->set_ioproxy(view_.get());
  OIIO::ImageSpec spec;
  if (input_->open(path_, spec, open_config())) return true;
  error = input_->geterror();
  if (error.empty()) error = "no reason given";
  return false;
}

bool OiioReader::select(int page, std::string& error) {
  if (page == selected_) return true;
  selected_ = -1;
  tile_row_index_ = -1;
  if (!seek(page, error)) return false;
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
  if (!select(page, error)) {
    static_cast<void>(input_->geterror());  // no more than "no such page"
    return false;
  }
  out = page_;
  return true;
} catch (const std::exception& failure) {
  error = failure.what();
  return false;
}

bool OiioReader::read_rows(int page, std::int64_t y0, std::int64_t y1, std::byte* out,
                           std::string& error) try {
  static_cast<void>(input_->geterror());  // what earlier warnings left there
  if (!select(page, error)) {
    if (error.empty()) error = "the page is not there any more";
    return false;
  }
  const OIIO::ImageSpec& spec = input_->spec();
  const bool done =
      page_.tile_height > 0
          ? read_tiled(y0, y1, out)
          : input_->read_scanlines(input_->current_subimage(), 0, spec.y + static_cast<int>(y0),
                                   spec.y + static_cast<int>(y1), spec.z, 0, spec.nchannels,
                                   oiio_type(page_.type), out);
  if (!done) {
    error = input_->geterror();
    if (error.empty()) error = "no reason given";
    return false;
  }
  if (page_.tile_height == 0)
    restore(page_, out,
            static_cast<std::size_t>((y1 - y0) * page_.width) *
                static_cast<std::size_t>(page_.channels));
  return true;
} catch (const std::exception& failure) {
  error = failure.what();
  return false;
}

bool OiioReader::read_tiled(std::int64_t y0, std::int64_t y1, std::byte* out) {
  const std::uint64_t row = row_bytes(page_);
  for (std::int64_t y = y0; y < y1;) {
    const std::int64_t index = y / page_.tile_height;
    if (!load_tile_row(index)) return false;
    const std::int64_t end = std::min(y1, (index + 1) * page_.tile_height);
    const std::uint64_t skip = static_cast<std::uint64_t>(y - index * page_.tile_height);
    const std::uint64_t bytes = static_cast<std::uint64_t>(end - y) * row;
    std::memcpy(out, tile_row_.data() + skip * row, bytes);
    out += bytes;
    y = end;
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
