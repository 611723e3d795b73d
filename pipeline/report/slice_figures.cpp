#include "pipeline/report/slice_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/report/contour.h"
#include "pipeline/report/html_text.h"
#include "pipeline/report/png.h"
#include "stages/encode/label_colour.h"

namespace voxweld {
namespace {

// More make a page too large. What has more is noise, of which a contour says nothing.
constexpr std::size_t most_points = 30'000;

using Colour = std::array<std::uint8_t, 3>;

// The one that is given; else as pictures of the mesh have it (pipeline/output/render.cpp).
Colour colour_of(const MaterialTable& colours, Material label) {
  const MaterialEntry* entry = colours.find(label);
  if (entry != nullptr && entry->color)
    return {entry->color->red, entry->color->green, entry->color->blue};
  Colour out{};
  const auto linear = label_colour(label);
  for (std::size_t i = 0; i < 3; ++i)
    out[i] =
        static_cast<std::uint8_t>(std::lround(255 * std::sqrt(std::clamp(linear[i], 0.0, 1.0))));
  return out;
}

Pixels grey_picture(const Slice& slice, const SliceStyle& style) {
  Pixels pixels{static_cast<int>(slice.columns.count), static_cast<int>(slice.rows.count), 1, {}};
  pixels.data.reserve(slice.values.size());
  const double scale = style.light > style.dark ? 255 / (style.light - style.dark) : 0;
  for (std::int64_t row = slice.rows.count - 1; row >= 0; --row)
    for (std::int64_t column = 0; column < slice.columns.count; ++column) {
      const double grey = (slice.values[slice.place(column, row)] - style.dark) * scale;
      pixels.data.push_back(
          std::isnan(grey) ? std::uint8_t{0}
                           : static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0, 255.0))));
    }
  return pixels;
}

// Label 0 and what is outside is dark; all other labels too where one alone is meshed.
Pixels label_picture(const Slice& slice, const SliceStyle& style) {
  constexpr Colour background{12, 13, 16}, other{84, 88, 96};
  Pixels pixels{static_cast<int>(slice.columns.count), static_cast<int>(slice.rows.count), 3, {}};
  pixels.data.reserve(3 * slice.labels.size());
  for (std::int64_t row = slice.rows.count - 1; row >= 0; --row)
    for (std::int64_t column = 0; column < slice.columns.count; ++column) {
      const Material label = slice.labels[slice.place(column, row)];
      Colour colour = background;
      if (style.label ? label == *style.label : label != 0 && label != exterior)
        colour = colour_of(style.colours, label);
      else if (label != 0 && label != exterior)
        colour = other;
      pixels.data.insert(pixels.data.end(), colour.begin(), colour.end());
    }
  return pixels;
}

// Where most samples are crossed there is nothing to see in a line; and in the page no room for it.
struct Overlay {
  std::string path, note;
};
Overlay overlay_of(const Slice& slice, const SliceStyle& style) {
  if (!style.isovalue || slice.values.empty()) return {};
  const auto lines = contour_of(slice, *style.isovalue, style.below);
  if (points_of(lines) > most_points)
    return {
        {},
        fmt::format("; the contour has {} points, too many to draw", grouped(points_of(lines)))};
  return {contour_path(lines, slice), lines.empty() ? "; the isovalue does not occur" : ""};
}

double length_of(const SampledSide& side, const SliceStyle& style) {
  return static_cast<double>(side.count * side.step) * style.spacing[side.axis];
}

}  // namespace

std::string css_colour(const MaterialTable& colours, Material label) {
  const Colour c = colour_of(colours, label);
  return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]);
}

std::string slice_figure(const Slice& slice, const SliceStyle& style) {
  constexpr const char* names = "xyz";
  const bool labels = slice.values.empty();
  const std::string picture =
      png_address(labels ? label_picture(slice, style) : grey_picture(slice, style));
  const Overlay overlay = overlay_of(slice, style);
  // In tenths of a sample, stretched to the lengths of the sides.
  const std::int64_t wide = 10 * slice.columns.count, high = 10 * slice.rows.count;
  const double across = length_of(slice.columns, style), up = length_of(slice.rows, style);
  const double place =
      style.first[slice.axis] + style.spacing[slice.axis] * static_cast<double>(slice.index);
  const std::string title = fmt::format("{} = {:.6g}{}{}", names[slice.axis], place,
                                        style.unit.empty() ? "" : " ", style.unit);
  std::string html = fmt::format(
      "<figure><svg class=\"slice\" viewBox=\"0 0 {} {}\" preserveAspectRatio=\"none\" "
      "style=\"aspect-ratio:{:.5g}\" role=\"img\" aria-label=\"Slice at {}\">"
      "<image href=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\"/>",
      wide, high, across / up, escaped(title), picture, wide, high);
  if (!overlay.path.empty())
    html += fmt::format("<path class=\"iso\" vector-effect=\"non-scaling-stroke\" d=\"{}\"/>",
                        overlay.path);
  html += fmt::format(
      "</svg><figcaption><b>{}</b> (slice {} of the {} axis); {} to the right, {} up{}</figcaption>"
      "</figure>\n",
      escaped(title), slice.index, names[slice.axis], names[slice.columns.axis],
      names[slice.rows.axis], overlay.note);
  return html;
}

}  // namespace voxweld
