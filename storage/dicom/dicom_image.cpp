#include "storage/dicom/dicom_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "storage/dicom/element_values.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

std::uint16_t required(const DataSet& data, DicomTag tag, const std::string& path) {
  const std::optional<std::uint16_t> value = data.u16(tag, path);
  if (!value)
    throw FormatError(fmt::format("{}: {} is missing: the header is damaged", path, tag_text(tag)));
  return *value;
}

SampleBits read_bits(const DataSet& data, const std::string& path) {
  SampleBits bits;
  bits.allocated = required(data, dicom::bits_allocated, path);
  bits.stored = data.u16(dicom::bits_stored, path).value_or(bits.allocated);
  bits.high = data.u16(dicom::high_bit, path).value_or(bits.stored - 1);
  bits.is_signed = data.u16(dicom::pixel_representation, path).value_or(0) != 0;
  return bits;
}

constexpr double most_frames = 65536;

std::size_t frame_count(const DataSet& data, const PixelPlace& place, const std::string& path) {
  const double count = data.number(dicom::number_of_frames, path).value_or(1);
  if (count > most_frames)
    throw FormatError(fmt::format("{}: {} is {:g}, and at most {:g} are read", path,
                                  tag_text(dicom::number_of_frames), count, most_frames));
  // A frame takes a byte of samples or an item of 8 bytes at least.
  if (count == 0) return 1;  // some writers of single slices
  if (!(count >= 1 && count <= static_cast<double>(place.length)) || count != std::floor(count))
    throw FormatError(fmt::format("{}: {} is {:g}, but there are {} bytes of samples", path,
                                  tag_text(dicom::number_of_frames), count, place.length));
  return static_cast<std::size_t>(count);
}

std::optional<std::int64_t> padding(const DataSet& data, DicomTag tag, const SampleBits& bits,
                                    const std::string& path) {
  const std::optional<std::uint16_t> value = data.u16(tag, path);
  if (!value) return std::nullopt;
  return bits.is_signed ? std::int64_t{static_cast<std::int16_t>(*value)} : std::int64_t{*value};
}

void read_identity(const DataSet& data, DicomImage& image) {
  image.series_uid = shown_text(data.text(dicom::series_uid));
  image.instance_uid = shown_text(data.text(dicom::instance_uid));
  image.modality = shown_text(data.text(dicom::modality));
  image.description = shown_text(data.text(dicom::series_description));
  image.series_number = parse_integer(data.text(dicom::series_number)).value_or(0);
  const std::string type = data.text(dicom::image_type);
  image.localizer = type.find("LOCALIZER") != std::string::npos;
}

// That the file can hold what the header states. What is compressed is not known before.
void check_extent(const DicomImage& image, std::size_t frames, const std::string& path) {
  const PixelPlace& place = image.place;
  const double bytes = static_cast<double>(image.rows) * static_cast<double>(image.columns) *
                       image.samples_per_pixel * image.bits.allocated / 8 *
                       static_cast<double>(frames);
  const bool native = image.syntax.coding == FrameCoding::native;
  if (native && !place.fragments && bytes > static_cast<double>(place.length))
    throw FormatError(fmt::format(
        "{}: {} x {} samples of {} bits in {} frame{} take {:.0f} bytes, but {} is {} bytes long: "
        "the file is damaged or cut short",
        path, image.columns, image.rows, image.bits.allocated, frames, frames == 1 ? "" : "s",
        bytes, tag_text(place.tag), place.length));
}

}  // namespace

std::optional<DicomImage> read_dicom_image(DicomBytes& bytes) {
  const std::string& path = bytes.path();
  DicomHeader header = read_dicom_header(bytes);
  const DataSet& data = header.data;
  if (header.place.tag == 0) {
    // Samples are promised, and the file ends before them.
    if (data.find(dicom::rows) != nullptr && data.find(dicom::bits_allocated) != nullptr)
      throw FormatError(
          fmt::format("{}: has no {}: the file is cut short, or its images are "
                      "elsewhere: copy it again or remove it",
                      path, tag_text(dicom::pixels)));
    return std::nullopt;
  }
  if (header.place.length > bytes.size() - header.place.offset)
    throw FormatError(fmt::format(
        "{}: truncated: {} is {} bytes long, but {} are left: copy the file again", path,
        tag_text(header.place.tag), header.place.length, bytes.size() - header.place.offset));
  DicomImage image;
  image.file = {path, bytes.state()};
  image.syntax = header.syntax;
  image.place = header.place;
  image.note = header.note;
  read_identity(data, image);
  image.rows = required(data, dicom::rows, path);
  image.columns = required(data, dicom::columns, path);
  if (image.rows == 0 || image.columns == 0)
    throw FormatError(fmt::format("{}: its size is {} x {}: the header is damaged", path,
                                  image.columns, image.rows));
  image.samples_per_pixel = data.u16(dicom::samples_per_pixel, path).value_or(1);
  image.photometric = shown_text(data.text(dicom::photometric));
  image.bits = read_bits(data, path);
  image.padding = padding(data, dicom::padding_value, image.bits, path);
  image.padding_limit = padding(data, dicom::padding_limit, image.bits, path);
  image.modality_table = data.item(dicom::modality_table) != nullptr;
  const std::size_t frames = frame_count(data, image.place, path);
  check_extent(image, frames, path);
  image.frames = read_frame_facts(data, frames, path);
  if (!image.frames.front().spacing) {
    const std::vector<double> at_detector = data.numbers(dicom::imager_spacing, 2, path);
    image.imager_spacing = !at_detector.empty();
    if (image.imager_spacing)
      for (FrameFacts& frame : image.frames) frame.spacing = {at_detector[0], at_detector[1]};
  }
  return image;
}

std::string image_objection(const DicomImage& image) {
  const SampleBits& bits = image.bits;
  if (image.samples_per_pixel != 1 || !image.photometric.starts_with("MONOCHROME"))
    return fmt::format(
        "its pixels are colours ({}, {} sample{} a pixel), and only MONOCHROME1 and "
        "MONOCHROME2 are read",
        image.photometric.empty() ? "of no stated kind" : image.photometric,
        image.samples_per_pixel, image.samples_per_pixel == 1 ? "" : "s");
  if (image.place.tag != dicom::pixels)
    return fmt::format("its samples are {}, and only integers are read", tag_text(image.place.tag));
  if (image.syntax.coding == FrameCoding::unknown)
    return fmt::format("its transfer syntax {} ({}) is not read: convert it with gdcmconv --raw",
                       image.syntax.uid, image.syntax.name);
  if (bits.allocated != 8 && bits.allocated != 16 && bits.allocated != 32)
    return fmt::format("its samples take {} bits, and only 8, 16 and 32 are read", bits.allocated);
  if (bits.stored < 1 || bits.high >= bits.allocated || bits.high + 1 < bits.stored)
    return fmt::format(
        "{} bits stored up to bit {} do not fit in {} allocated: the header is "
        "damaged",
        bits.stored, bits.high, bits.allocated);
  if ((image.syntax.coding == FrameCoding::native) == image.place.fragments)
    return fmt::format("its transfer syntax is {} ({}), but its samples are {}stored in fragments",
                       image.syntax.uid, image.syntax.name, image.place.fragments ? "" : "not ");
  if (image.syntax.coding != FrameCoding::native && bits.high + 1 != bits.stored)
    return fmt::format(
        "its {} bits are stored up to bit {} of compressed samples, which is not "
        "supported",
        bits.stored, bits.high);
  if (image.syntax.order == std::endian::big && bits.allocated == 8 && image.place.vr == "OW")
    return "its samples of 8 bits are big endian words of 16 bits, which is not supported";
  return {};
}

SampleType image_sample_type(const SampleBits& bits) {
  if (bits.allocated == 8) return bits.is_signed ? SampleType::i8 : SampleType::u8;
  if (bits.allocated == 16) return bits.is_signed ? SampleType::i16 : SampleType::u16;
  return bits.is_signed ? SampleType::i32 : SampleType::u32;
}

}  // namespace voxweld
