#include "storage/dicom/choose_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

// The digits that orientations are written with differ between slices of some scanners.
constexpr double same_direction = 1e-4, same_spacing = 1e-4;
constexpr std::size_t listed_choices = 40, most_groups = 2000;

bool alike(const std::optional<std::array<Vec3, 2>>& a,
           const std::optional<std::array<Vec3, 2>>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  for (std::size_t i = 0; i < 2; ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs((*a)[i][axis] - (*b)[i][axis]) > same_direction) return false;
  return true;
}

bool alike(const std::optional<std::array<double, 2>>& a,
           const std::optional<std::array<double, 2>>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  for (std::size_t i = 0; i < 2; ++i)
    if (std::abs((*a)[i] - (*b)[i]) > same_spacing * std::abs((*a)[i])) return false;
  return true;
}

bool alike(const DicomImage& a, const FrameFacts& of_a, const DicomImage& b,
           const FrameFacts& of_b) {
  return a.localizer == b.localizer && a.rows == b.rows && a.columns == b.columns &&
         a.bits == b.bits && a.place.tag == b.place.tag &&
         a.samples_per_pixel == b.samples_per_pixel && a.photometric == b.photometric &&
         of_a.stack == of_b.stack && alike(of_a.spacing, of_b.spacing) &&
         alike(of_a.orientation, of_b.orientation);
}

struct Listed {
  const std::vector<DicomImage>& images;
  const DicomGroup& group;

  const DicomImage& image() const { return images[group.slices.front().image]; }
  const FrameFacts& frame() const { return image().frames[group.slices.front().frame]; }
  bool usable() const { return !image().localizer && image_objection(image()).empty(); }
};

// The middle one of the distances between neighbouring positions; 0 where there is none.
double slice_distance(const Listed& listed) {
  const FrameFacts& first = listed.frame();
  if (!first.orientation) return 0;
  const Vec3 normal = cross((*first.orientation)[0], (*first.orientation)[1]);
  std::vector<double> at, gaps;
  for (const DicomSlice& slice : listed.group.slices)
    if (const auto& p = listed.images[slice.image].frames[slice.frame].position)
      at.push_back(dot(*p, normal));
  std::ranges::sort(at);
  for (std::size_t i = 1; i < at.size(); ++i)
    if (at[i] > at[i - 1]) gaps.push_back(at[i] - at[i - 1]);
  if (gaps.empty()) return 0;
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::ranges::nth_element(gaps, middle);
  return *middle;
}

std::string describe(const Listed& listed) {
  const DicomImage& image = listed.image();
  std::string text = fmt::format("series {}, {}", image.series_number,
                                 image.modality.empty() ? "no modality" : image.modality);
  if (image.localizer) text += ", localizer";
  if (!image.description.empty()) text += fmt::format(", '{}'", image.description);
  text += fmt::format(", {} x {} x {}", image.columns, image.rows, listed.group.slices.size());
  if (image.samples_per_pixel != 1) text += " in colours";
  if (const auto& spacing = listed.frame().spacing) {
    const double distance = slice_distance(listed);
    text += fmt::format(", {:.4g} x {:.4g}", (*spacing)[1], (*spacing)[0]);
    text += distance > 0 ? fmt::format(" x {:.4g} mm", distance) : " mm";
  }
  return text + ", UID " + (image.series_uid.empty() ? "missing" : image.series_uid);
}

std::string list_text(const VolumeInfo& info) {
  std::string text;
  for (std::size_t i = 0; i < std::min(listed_choices, info.choices.size()); ++i)
    text += fmt::format("\n  {}: {}", info.choices[i].value, info.choices[i].text);
  if (info.choices.size() > listed_choices)
    text += fmt::format("\n  and {} more", info.choices.size() - listed_choices);
  return text;
}

// Of those that can be volumes the numbers, or of these alone where there are any.
std::vector<std::size_t> candidates(const std::vector<Listed>& all, const std::string& uid) {
  std::vector<std::size_t> usable, any;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!uid.empty() && all[i].image().series_uid != uid) continue;
    any.push_back(i);
    if (all[i].usable()) usable.push_back(i);
  }
  return usable.empty() ? any : usable;
}

std::size_t by_name(const std::vector<Listed>& all, const InputSpec& spec, const VolumeInfo& info) {
  const std::string& wanted = spec.select.series;
  const auto number = parse_integer(wanted);
  if (number && *number >= 1 && *number <= static_cast<std::int64_t>(all.size()))
    return static_cast<std::size_t>(*number - 1);
  const std::vector<std::size_t> found = candidates(all, wanted);
  if (found.size() == 1) return found.front();
  throw InputError(fmt::format(
      "{}: {} '{}' (input.series or --series); choose by the number in this list{}:{}", spec.path,
      found.empty() ? "has no series" : fmt::format("has {} volumes of the series", found.size()),
      wanted, found.empty() ? " or by the UID" : "", list_text(info)));
}

std::size_t by_itself(const std::vector<Listed>& all, const InputSpec& spec, VolumeInfo& info) {
  const std::vector<std::size_t> found = candidates(all, {});
  if (found.size() > 1 && !spec.survey)
    throw InputError(fmt::format(
        "{}: holds {} volumes: set input.series or --series to the number or UID of one:{}",
        spec.path, all.size(), list_text(info)));
  const std::size_t others = all.size() - 1;
  if (others > 0)
    info.warnings.push_back(
        found.size() > 1
            ? fmt::format("{}: holds {} volumes, of which this is number {}; --series chooses",
                          spec.path, all.size(), found.front() + 1)
            : fmt::format("{}: {} other group{} of images, localizers or such as are not read, {} "
                          "left aside; --series chooses among all",
                          spec.path, others, others == 1 ? "" : "s", others == 1 ? "is" : "are"));
  return found.front();
}

}  // namespace

std::vector<DicomGroup> group_slices(const std::vector<DicomImage>& images) {
  std::vector<DicomGroup> groups;
  for (std::size_t i = 0; i < images.size(); ++i)
    for (std::size_t f = 0; f < images[i].frames.size(); ++f) {
      const auto same = [&](const DicomGroup& group) {
        const DicomSlice& first = group.slices.front();
        const DicomImage& other = images[first.image];
        return other.series_uid == images[i].series_uid &&
               alike(other, other.frames[first.frame], images[i], images[i].frames[f]);
      };
      // Most belong to the latest.
      const auto found = std::find_if(groups.rbegin(), groups.rend(), same);
      if (found == groups.rend()) {
        if (groups.size() == most_groups)
          throw FormatError(
              fmt::format("{}: frame {} differs from all before it in size, samples, orientation "
                          "or spacing, as "
                          "{} others do: name the folder of one series",
                          images[i].file.path, f + 1, most_groups));
        groups.push_back({{{i, f}}});
      } else {
        found->slices.push_back({i, f});
      }
    }
  std::ranges::stable_sort(groups, [&](const DicomGroup& a, const DicomGroup& b) {
    const DicomImage &left = images[a.slices.front().image],
                     &right = images[b.slices.front().image];
    return std::tie(left.series_number, left.series_uid) <
           std::tie(right.series_number, right.series_uid);
  });
  return groups;
}

std::size_t choose_group(const std::vector<DicomImage>& images,
                         const std::vector<DicomGroup>& groups, const InputSpec& spec,
                         VolumeInfo& info) {
  std::vector<Listed> all;
  for (const DicomGroup& group : groups) all.push_back({images, group});
  if (all.size() > 1)
    for (std::size_t i = 0; i < all.size(); ++i)
      info.choices.push_back({.selector = selector_name(Selector::series),
                              .value = std::to_string(i + 1),
                              .text = describe(all[i])});
  const std::size_t chosen =
      spec.select.series.empty() ? by_itself(all, spec, info) : by_name(all, spec, info);
  if (all.size() > 1) info.choices[chosen].chosen = true;
  return chosen;
}

}  // namespace voxweld
