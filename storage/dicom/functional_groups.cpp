#include <fmt/format.h>

#include <cmath>

#include "storage/dicom/dicom_image.h"
#include "storage/dicom/element_values.h"
#include "storage/support/error.h"
#include "storage/volumes/axes.h"

namespace voxweld {
namespace {

// The digits of ImageOrientationPatient leave vectors a little off unit length.
constexpr double unit_tolerance = 0.02;

bool finite(Vec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void read_position(const DataSet& data, const std::string& path, FrameFacts& out) {
  const std::vector<double> p = data.numbers(dicom::position, 3, path);
  if (p.empty()) return;
  out.position = Vec3{p[0], p[1], p[2]};
  if (!finite(*out.position))
    throw FormatError(fmt::format("{}: {} is not finite: the header is damaged", path,
                                  tag_text(dicom::position)));
}

void read_orientation(const DataSet& data, const std::string& path, FrameFacts& out) {
  const std::vector<double> o = data.numbers(dicom::orientation, 6, path);
  if (o.empty()) return;
  const Vec3 row{o[0], o[1], o[2]}, column{o[3], o[4], o[5]};
  const double a = length(row), b = length(column);
  const bool sound = std::abs(a - 1) < unit_tolerance && std::abs(b - 1) < unit_tolerance &&
                     std::abs(dot(row, column)) < unit_tolerance;
  if (!sound)
    throw FormatError(fmt::format(
        "{}: {}: ({:g}, {:g}, {:g}) and ({:g}, {:g}, {:g}) are no perpendicular unit "
        "vectors: the header is damaged",
        path, tag_text(dicom::orientation), row.x, row.y, row.z, column.x, column.y, column.z));
  out.orientation = {row * (1 / a), column * (1 / b)};
}

void read_measures(const DataSet& data, const std::string& path, FrameFacts& out) {
  const std::vector<double> spacing = data.numbers(dicom::pixel_spacing, 2, path);
  if (!spacing.empty()) out.spacing = {spacing[0], spacing[1]};
  out.slice_spacing = data.number(dicom::slice_spacing, path).value_or(out.slice_spacing);
  out.thickness = data.number(dicom::slice_thickness, path).value_or(out.thickness);
}

void read_values(const DataSet& data, const std::string& path, FrameFacts& out) {
  out.slope = data.number(dicom::slope, path).value_or(out.slope);
  out.intercept = data.number(dicom::intercept, path).value_or(out.intercept);
}

// What one item of the functional groups says, over what was said before.
void read_group(const DataSet& group, const std::string& path, FrameFacts& out) {
  if (const DataSet* item = group.item(dicom::plane_position)) read_position(*item, path, out);
  if (const DataSet* item = group.item(dicom::plane_orientation))
    read_orientation(*item, path, out);
  if (const DataSet* item = group.item(dicom::pixel_measures)) read_measures(*item, path, out);
  if (const DataSet* item = group.item(dicom::value_transformation)) read_values(*item, path, out);
  if (const DataSet* item = group.item(dicom::frame_content)) {
    out.stack = shown_text(item->text(dicom::stack_id));
    // An unsigned number of 4 bytes, of which the lower two will do.
    if (const auto time = item->u16(dicom::temporal_index, path)) out.time = std::to_string(*time);
  }
}

// The frames of a dose grid lie at these distances from the first (PS3.3, C.8.8.3.2).
void read_grid_offsets(const DataSet& data, const std::string& path,
                       std::vector<FrameFacts>& frames) {
  const FrameFacts& first = frames.front();
  if (!first.position || !first.orientation) return;
  const std::vector<double> at = data.numbers(dicom::grid_offsets, frames.size(), path);
  if (at.empty()) return;
  const Vec3 normal = cross((*first.orientation)[0], (*first.orientation)[1]);
  // Offsets from the first frame, or, where that is not 0, positions.
  const double begin = at[0];
  for (std::size_t f = frames.size(); f-- > 0;)
    frames[f].position = *first.position + normal * (at[f] - begin);
}

}  // namespace

std::vector<FrameFacts> read_frame_facts(const DataSet& data, std::size_t count,
                                         const std::string& path) {
  FrameFacts common;
  if (const DataSet* detector = data.item(dicom::detector_information)) {
    read_position(*detector, path, common);
    read_orientation(*detector, path, common);
  }
  read_position(data, path, common);
  read_orientation(data, path, common);
  read_measures(data, path, common);
  read_values(data, path, common);
  common.slope = data.number(dicom::dose_scaling, path).value_or(common.slope);
  common.time = shown_text(data.text(dicom::temporal_position));
  if (const DataSet* shared = data.item(dicom::shared_groups)) read_group(*shared, path, common);
  // One position in the header is that of the first frame.
  const DicomElement* groups = data.find(dicom::frame_groups);
  std::vector<FrameFacts> frames(count, common);
  if (groups == nullptr) {
    if (count == 1) return frames;
    read_grid_offsets(data, path, frames);
    if (data.find(dicom::grid_offsets) == nullptr)
      for (std::size_t f = 1; f < count; ++f) frames[f].position.reset();
    return frames;
  }
  if (groups->items.size() != count)
    throw FormatError(fmt::format("{}: has {} frames, but {} of {} items: the header is damaged",
                                  path, count, tag_text(dicom::frame_groups),
                                  groups->items.size()));
  for (std::size_t f = 0; f < count; ++f) read_group(groups->items[f], path, frames[f]);
  return frames;
}

}  // namespace voxweld
