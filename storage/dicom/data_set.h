// The data elements of a DICOM file that matter to a volume (PS3.5, chapter 7), up to its samples.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/dicom/dicom_bytes.h"
#include "storage/dicom/transfer_syntax.h"

namespace voxweld {

// Group and element number.
using DicomTag = std::uint32_t;

// Those that are kept, of which all others are passed over.
namespace dicom {
inline constexpr DicomTag syntax_uid = 0x00020010, directory_records = 0x00041220,
                          referenced_file = 0x00041500, image_type = 0x00080008,
                          class_uid = 0x00080016, instance_uid = 0x00080018, modality = 0x00080060,
                          series_description = 0x0008103e, slice_thickness = 0x00180050,
                          slice_spacing = 0x00180088, imager_spacing = 0x00181164,
                          series_uid = 0x0020000e, series_number = 0x00200011,
                          acquisition_number = 0x00200012, instance_number = 0x00200013,
                          position = 0x00200032, orientation = 0x00200037,
                          temporal_position = 0x00200100, stack_id = 0x00209056,
                          frame_content = 0x00209111, plane_position = 0x00209113,
                          plane_orientation = 0x00209116, temporal_index = 0x00209128,
                          samples_per_pixel = 0x00280002, photometric = 0x00280004,
                          number_of_frames = 0x00280008, rows = 0x00280010, columns = 0x00280011,
                          pixel_spacing = 0x00280030, bits_allocated = 0x00280100,
                          bits_stored = 0x00280101, high_bit = 0x00280102,
                          pixel_representation = 0x00280103, padding_value = 0x00280120,
                          padding_limit = 0x00280121, intercept = 0x00281052, slope = 0x00281053,
                          modality_table = 0x00283000, pixel_measures = 0x00289110,
                          value_transformation = 0x00289145, detector_information = 0x00540022,
                          grid_offsets = 0x3004000c, dose_scaling = 0x3004000e,
                          shared_groups = 0x52009229, frame_groups = 0x52009230,
                          float_pixels = 0x7fe00008, double_pixels = 0x7fe00009,
                          pixels = 0x7fe00010;
}  // namespace dicom

// "(0028,0010) Rows": for messages.
std::string tag_text(DicomTag tag);

struct DicomElement;

struct DataSet {
  std::vector<DicomElement> elements;
  std::endian order = std::endian::little;

  const DicomElement* find(DicomTag tag) const;
  // The first item of a sequence; null where there is none.
  const DataSet* item(DicomTag sequence) const;
  // Without the blanks around it; empty where it is missing.
  std::string text(DicomTag tag) const;
  // The numbers of a text, and one of two bytes. FormatError through `path` where they are none, or
  // others than `count` (0: any); nothing where the element is missing or empty.
  std::vector<double> numbers(DicomTag tag, std::size_t count, const std::string& path) const;
  std::optional<double> number(DicomTag tag, const std::string& path) const;
  std::optional<std::uint16_t> u16(DicomTag tag, const std::string& path) const;
};

struct DicomElement {
  DicomTag tag = 0;
  std::string value;           // its bytes
  std::vector<DataSet> items;  // of a sequence
};

// Where the samples are.
struct PixelPlace {
  DicomTag tag = 0;  // which of the three kinds; 0: there are none
  std::string vr;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  bool fragments = false;  // of no stated length: items to the end of the sequence
};

struct DicomHeader {
  TransferSyntax syntax;
  DataSet data;
  PixelPlace place;
  std::string note;  // what is odd about the file and does not hinder reading it; mostly empty
};

// Reads up to the samples. A deflated file is inflated for that, which `bytes` then holds.
// FormatError where a length leads beyond the file or its sequence, and where there are no elements.
DicomHeader read_dicom_header(DicomBytes& bytes);

}  // namespace voxweld
