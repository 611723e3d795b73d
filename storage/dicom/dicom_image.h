// What one DICOM file says of its frames: size, samples, where they are in the patient.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "storage/dicom/data_set.h"
#include "storage/types/box.h"
#include "storage/types/sample_type.h"
#include "storage/types/value_scale.h"
#include "storage/types/volume.h"

namespace voxweld {

// How a sample lies in its bits.
struct SampleBits {
  int allocated = 0, stored = 0, high = 0;  // bits; the number of the highest one
  bool is_signed = false;
  friend bool operator==(const SampleBits&, const SampleBits&) = default;
};

// Lengths in mm, positions in the patient: x to the left, y to the back, z to the head.
struct FrameFacts {
  std::optional<Vec3> position;  // of the centre of the first sample
  // Unit vectors along a row and down a column.
  std::optional<std::array<Vec3, 2>> orientation;
  std::optional<std::array<double, 2>> spacing;  // of rows (along y), of columns (along x)
  double slice_spacing = 0, thickness = 0;       // 0: it does not say
  double slope = 1, intercept = 0;               // as stated
  std::string stack, time;                       // of multi-frame files; else time alone or neither
};

struct DicomImage {
  InputFile file;
  TransferSyntax syntax;
  PixelPlace place;
  std::string series_uid, instance_uid, modality, description;
  std::int64_t series_number = 0;
  bool localizer = false;
  std::int64_t rows = 0, columns = 0;
  int samples_per_pixel = 1;
  std::string photometric;
  SampleBits bits;
  bool modality_table = false;
  bool imager_spacing = false;  // the frames' spacing is that at the detector
  std::optional<std::int64_t> padding, padding_limit;  // stored samples
  std::vector<FrameFacts> frames;                      // at least one
  std::string note;

  std::uint64_t frame_bytes() const {
    return static_cast<std::uint64_t>(rows * columns * (bits.allocated / 8));
  }
};

// Reads the header of the file. Nothing where the file holds no samples (reports, directories). Of
// what cannot be a volume (colours, odd bits) only the facts are stated, see image_objection().
// FormatError where the header is damaged, or states more than the file can hold.
std::optional<DicomImage> read_dicom_image(DicomBytes& bytes);

// Why its samples are not read; empty where they are.
std::string image_objection(const DicomImage& image);

// Of samples to which there is no objection.
SampleType image_sample_type(const SampleBits& bits);

// The facts of each frame, from the functional groups of an enhanced multi-frame file or from the
// header itself.
std::vector<FrameFacts> read_frame_facts(const DataSet& data, std::size_t frames,
                                         const std::string& path);

}  // namespace voxweld
