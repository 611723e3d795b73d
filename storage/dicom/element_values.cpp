#include "storage/dicom/element_values.h"

#include <fmt/format.h>

#include <algorithm>

#include "storage/support/byte_order.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

struct KeptElement {
  DicomTag tag;
  std::string_view name;
  bool sequence = false;
};

// By rising tag.
constexpr KeptElement kept_elements[] = {
    {dicom::syntax_uid, "TransferSyntaxUID"},
    {dicom::directory_records, "DirectoryRecordSequence", true},
    {dicom::referenced_file, "ReferencedFileID"},
    {dicom::image_type, "ImageType"},
    {dicom::class_uid, "SOPClassUID"},
    {dicom::instance_uid, "SOPInstanceUID"},
    {dicom::modality, "Modality"},
    {dicom::series_description, "SeriesDescription"},
    {dicom::slice_thickness, "SliceThickness"},
    {dicom::slice_spacing, "SpacingBetweenSlices"},
    {dicom::imager_spacing, "ImagerPixelSpacing"},
    {dicom::series_uid, "SeriesInstanceUID"},
    {dicom::series_number, "SeriesNumber"},
    {dicom::acquisition_number, "AcquisitionNumber"},
    {dicom::instance_number, "InstanceNumber"},
    {dicom::position, "ImagePositionPatient"},
    {dicom::orientation, "ImageOrientationPatient"},
    {dicom::temporal_position, "TemporalPositionIdentifier"},
    {dicom::stack_id, "StackID"},
    {dicom::frame_content, "FrameContentSequence", true},
    {dicom::plane_position, "PlanePositionSequence", true},
    {dicom::plane_orientation, "PlaneOrientationSequence", true},
    {dicom::temporal_index, "TemporalPositionIndex"},
    {dicom::samples_per_pixel, "SamplesPerPixel"},
    {dicom::photometric, "PhotometricInterpretation"},
    {dicom::number_of_frames, "NumberOfFrames"},
    {dicom::rows, "Rows"},
    {dicom::columns, "Columns"},
    {dicom::pixel_spacing, "PixelSpacing"},
    {dicom::bits_allocated, "BitsAllocated"},
    {dicom::bits_stored, "BitsStored"},
    {dicom::high_bit, "HighBit"},
    {dicom::pixel_representation, "PixelRepresentation"},
    {dicom::padding_value, "PixelPaddingValue"},
    {dicom::padding_limit, "PixelPaddingRangeLimit"},
    {dicom::intercept, "RescaleIntercept"},
    {dicom::slope, "RescaleSlope"},
    {dicom::modality_table, "ModalityLUTSequence", true},
    {dicom::pixel_measures, "PixelMeasuresSequence", true},
    {dicom::value_transformation, "PixelValueTransformationSequence", true},
    {dicom::detector_information, "DetectorInformationSequence", true},
    {dicom::grid_offsets, "GridFrameOffsetVector"},
    {dicom::dose_scaling, "DoseGridScaling"},
    {dicom::shared_groups, "SharedFunctionalGroupsSequence", true},
    {dicom::frame_groups, "PerFrameFunctionalGroupsSequence", true},
    {dicom::float_pixels, "FloatPixelData"},
    {dicom::double_pixels, "DoubleFloatPixelData"},
    {dicom::pixels, "PixelData"},
};
static_assert(std::ranges::is_sorted(kept_elements, {}, &KeptElement::tag));

const KeptElement* kept_element(DicomTag tag) {
  const auto* found = std::ranges::lower_bound(kept_elements, tag, {}, &KeptElement::tag);
  return found != std::end(kept_elements) && found->tag == tag ? found : nullptr;
}

}  // namespace

bool is_kept(DicomTag tag) {
  return kept_element(tag) != nullptr;
}

bool is_kept_sequence(DicomTag tag) {
  const KeptElement* found = kept_element(tag);
  return found != nullptr && found->sequence;
}

std::string tag_text(DicomTag tag) {
  const KeptElement* found = kept_element(tag);
  return fmt::format("({:04x},{:04x}){}{}", tag >> 16, tag & 0xffffU, found != nullptr ? " " : "",
                     found != nullptr ? found->name : "");
}

std::string trimmed_value(std::string_view value) {
  constexpr std::string_view fill(" \0\t\r\n", 5);
  const std::size_t begin = value.find_first_not_of(fill);
  if (begin == std::string_view::npos) return {};
  return std::string(value.substr(begin, value.find_last_not_of(fill) - begin + 1));
}

std::string shown_text(std::string_view value) {
  std::string text(value.substr(0, 64));
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return text;
}

const DicomElement* DataSet::find(DicomTag tag) const {
  const auto found = std::ranges::find(elements, tag, &DicomElement::tag);
  return found != elements.end() ? &*found : nullptr;
}

const DataSet* DataSet::item(DicomTag sequence) const {
  const DicomElement* found = find(sequence);
  return found != nullptr && !found->items.empty() ? &found->items.front() : nullptr;
}

std::string DataSet::text(DicomTag tag) const {
  const DicomElement* found = find(tag);
  return found != nullptr ? trimmed_value(found->value) : std::string();
}

std::vector<double> DataSet::numbers(DicomTag tag, std::size_t count,
                                     const std::string& path) const {
  const std::string whole = text(tag);
  std::vector<double> numbers;
  if (whole.empty()) return numbers;
  std::string_view rest = whole;
  while (true) {
    const std::size_t bar = rest.find('\\');
    const std::optional<double> number = parse_real(trimmed_value(rest.substr(0, bar)));
    if (!number) break;
    numbers.push_back(*number);
    if (bar == std::string_view::npos) {
      if (count != 0 && numbers.size() != count) break;
      return numbers;
    }
    rest.remove_prefix(bar + 1);
  }
  throw FormatError(
      fmt::format("{}: {}: expected {}, found '{}': the header is damaged", path, tag_text(tag),
                  count == 0 ? "numbers" : fmt::format("{} number{}", count, count == 1 ? "" : "s"),
                  shown_text(whole)));
}

std::optional<double> DataSet::number(DicomTag tag, const std::string& path) const {
  const std::vector<double> found = numbers(tag, 1, path);
  return found.empty() ? std::nullopt : std::optional(found.front());
}

std::optional<std::uint16_t> DataSet::u16(DicomTag tag, const std::string& path) const {
  const DicomElement* found = find(tag);
  if (found == nullptr || found->value.empty()) return std::nullopt;
  if (found->value.size() < 2)
    throw FormatError(fmt::format("{}: {}: expected a number of 2 bytes, found {}", path,
                                  tag_text(tag), found->value.size()));
  return load_as<std::uint16_t>(reinterpret_cast<const std::byte*>(found->value.data()), 0, order);
}

}  // namespace voxweld
