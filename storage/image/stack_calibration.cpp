#include "storage/image/stack_calibration.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

namespace voxweld {
namespace {

std::optional<double> parse_number(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

struct Unit {
  std::string name;
  double factor = 1;  // lengths in `name` = factor * lengths in the file's unit
};

// Units as ImageJ, OME and the TIFF tag spell them. Inches and centimetres become millimetres.
Unit canonical_unit(std::string_view text) {
  if (text == "micron" || text == "microns" || text == "um" || text == "\xC2\xB5m" ||
      text == "\xCE\xBCm" || text == "\\u00B5m" || text == "micrometer")
    return {"um", 1};
  if (text == "mm" || text == "millimeter") return {"mm", 1};
  if (text == "nm" || text == "nanometer") return {"nm", 1};
  if (text == "m" || text == "meter") return {"m", 1};
  if (text == "cm" || text == "centimeter" || text == "3") return {"mm", 10};
  if (text == "in" || text == "inch" || text == "inches" || text == "2") return {"mm", 25.4};
  if (text.empty() || text == " " || text == "pixel" || text == "pixels" || text == "none")
    return {};
  return {std::string(text), 1};
}

// Lengths in one unit are this times the lengths in the other; nothing where that is not known.
std::optional<double> length_ratio(const std::string& from, const std::string& to) {
  if (from == to) return 1;
  const auto metres = [](const std::string& unit) {
    if (unit == "nm") return 1e-9;
    if (unit == "um") return 1e-6;
    if (unit == "mm") return 1e-3;
    return unit == "m" ? 1.0 : 0.0;
  };
  if (metres(from) == 0 || metres(to) == 0) return std::nullopt;
  return metres(from) / metres(to);
}

StackCalibration from_imagej(const ImagePage& page, const StackFileFacts& facts) {
  StackCalibration result;
  const Unit unit = canonical_unit(imagej_value(page.description, "unit"));
  const std::optional<double> z = parse_number(imagej_value(page.description, "spacing"));
  const bool has_xy = page.x_resolution > 0 && page.y_resolution > 0;
  // ImageJ leaves `spacing` out at 1, and also where nobody calibrated z; taking 1 would stretch
  // the latter.
  if (z && *z != 0 && has_xy) {
    result.spacing = Vec3{unit.factor / page.x_resolution, unit.factor / page.y_resolution,
                          unit.factor * std::abs(*z)};
    result.unit = unit.name;
  } else if (has_xy && (page.x_resolution != 1 || page.y_resolution != 1)) {
    result.warnings.push_back(
        fmt::format("{}: the description gives pixels of {:g} x {:g}{}{} but no distance of "
                    "slices; spacing 1 is "
                    "used on all axes unless the input's spacing is set",
                    facts.path, unit.factor / page.x_resolution, unit.factor / page.y_resolution,
                    unit.name.empty() ? "" : " ", unit.name));
  }
  return result;
}

StackCalibration from_tags(const ImagePage& page, const StackFileFacts& facts) {
  StackCalibration result;
  const Unit unit = canonical_unit(page.resolution_unit);
  const bool physical = !unit.name.empty() && page.x_resolution > 0 && page.y_resolution > 0;
  // Whole dots per inch up to 600 are what editors and printers write, not a scan's voxel size.
  const bool printer = unit.factor == 25.4 && page.x_resolution <= 600 &&
                       page.x_resolution == std::floor(page.x_resolution);
  if (physical && !printer)
    result.warnings.push_back(fmt::format(
        "{}: its resolution says {:g} x {:g} {} a pixel, but nothing the distance of slices; "
        "spacing 1 is used on all axes unless the input's spacing is set",
        facts.path, unit.factor / page.x_resolution, unit.factor / page.y_resolution, unit.name));
  return result;
}

}  // namespace

std::string_view imagej_value(std::string_view description, std::string_view key) {
  for (std::size_t at = 0; at < description.size();) {
    const std::size_t end = std::min(description.find('\n', at), description.size());
    const std::string_view line = description.substr(at, end - at);
    if (line.size() > key.size() && line.starts_with(key) && line[key.size()] == '=')
      return line.substr(key.size() + 1);
    at = end + 1;
  }
  return {};
}

StackCalibration ome_calibration(const OmeImage& image, const std::string& path) {
  StackCalibration result;
  Vec3 spacing;
  std::string first_unit;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    const std::optional<double> size = parse_number(image.step[at]);
    if (!size || !(*size > 0)) return result;
    const Unit unit = canonical_unit(image.unit[at]);
    if (axis == 0) first_unit = unit.name;
    const std::optional<double> scale = length_ratio(unit.name, first_unit);
    if (!scale) {
      result.warnings.push_back(fmt::format(
          "{}: the OME sizes are in units that do not go together ('{}', '{}'); spacing 1 is used "
          "on all axes unless the input's spacing is set",
          path, first_unit, unit.name));
      return result;
    }
    spacing[axis] = *size * unit.factor * *scale;
  }
  result.unit = first_unit;
  result.spacing = spacing;
  return result;
}

StackCalibration read_calibration(const ImagePage& first, const StackFileFacts& facts) {
  if (first.description.starts_with("ImageJ=")) return from_imagej(first, facts);
  return from_tags(first, facts);
}

}  // namespace voxweld
