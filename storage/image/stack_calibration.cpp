#include "storage/image/stack_calibration.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include "storage/support/error.h"

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

// "key=value" of a line of ImageJ's description; empty when absent.
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

void refuse_second_axis(const std::string& path, const char* axis, double count) {
  throw FormatError(fmt::format(
      "{}: holds {:g} {}, so its pages are not one volume; expected one channel and one time: save "
      "the part to be meshed as a stack of its own",
      path, count, axis));
}

double imagej_count(std::string_view description, std::string_view key) {
  return parse_number(imagej_value(description, key)).value_or(1);
}

void check_imagej_axes(std::string_view text, const StackFileFacts& facts) {
  const double images = imagej_count(text, "images"), slices = imagej_count(text, "slices");
  const double frames = imagej_count(text, "frames");
  if (const double channels = imagej_count(text, "channels"); channels > 1)
    refuse_second_axis(facts.path, "channels", channels);
  // ImageJ often keeps z as time: only both at once are ambiguous.
  if (frames > 1 && slices > 1) refuse_second_axis(facts.path, "times", frames);
  if (images > 1 && facts.pages == 1)
    throw FormatError(
        fmt::format("{}: ImageJ wrote {:g} images here but a directory for one only, as it does "
                    "over 4 GiB; save "
                    "it as BigTIFF or as an image sequence",
                    facts.path, images));
}

StackCalibration from_imagej(const ImagePage& page, const StackFileFacts& facts) {
  StackCalibration result;
  check_imagej_axes(page.description, facts);
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

// The value of an attribute of the first <Pixels ...> element; empty when absent.
std::string_view ome_attribute(std::string_view xml, std::string_view name) {
  const std::size_t begin = xml.find("<Pixels");
  if (begin == std::string_view::npos) return {};
  const std::string_view element = xml.substr(begin, xml.find('>', begin) - begin);
  const std::string wanted = fmt::format(" {}=\"", name);
  const std::size_t at = element.find(wanted);
  if (at == std::string_view::npos) return {};
  const std::size_t start = at + wanted.size();
  return element.substr(start, element.find('"', start) - start);
}

StackCalibration from_ome(const ImagePage& page, const StackFileFacts& facts) {
  const std::string_view xml = page.description;
  const double channels = parse_number(ome_attribute(xml, "SizeC")).value_or(1);
  const double times = parse_number(ome_attribute(xml, "SizeT")).value_or(1);
  if (channels > 1) refuse_second_axis(facts.path, "channels", channels);
  if (times > 1 && parse_number(ome_attribute(xml, "SizeZ")).value_or(1) > 1)
    refuse_second_axis(facts.path, "times", times);
  StackCalibration result;
  Vec3 spacing;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = fmt::format("PhysicalSize{}", "XYZ"[axis]);
    const std::optional<double> size = parse_number(ome_attribute(xml, name));
    if (!size || !(*size > 0)) return result;
    std::string_view unit_text = ome_attribute(xml, name + "Unit");
    const Unit unit = canonical_unit(unit_text.empty() ? "um" : unit_text);
    if (axis > 0 && unit.name != result.unit) {
      result.unit.clear();
      result.warnings.push_back(fmt::format(
          "{}: the OME sizes are in different units; spacing 1 is used on all axes unless the "
          "input's spacing is set",
          facts.path));
      return result;
    }
    result.unit = unit.name;
    spacing[axis] = *size * unit.factor;
  }
  result.spacing = spacing;
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

StackCalibration read_calibration(const ImagePage& first, const StackFileFacts& facts) {
  if (first.description.starts_with("ImageJ=")) return from_imagej(first, facts);
  if (first.description.find("<OME") != std::string::npos) return from_ome(first, facts);
  return from_tags(first, facts);
}

}  // namespace voxweld
