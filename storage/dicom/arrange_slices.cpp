#include "storage/dicom/arrange_slices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "storage/dicom/slice_steps.h"
#include "storage/support/error.h"
#include "storage/volumes/axes.h"

namespace voxweld {
namespace {

constexpr std::size_t listed_slices = 10;
// Closer than this part of the distance of samples in a slice, two slices are at one place.
constexpr double one_place = 1e-3;
// Interpolated slices for each that there is, at most.
constexpr double most_planes = 64;
// What is said: a tilt from here on, as rounded positions have less, and deviations of even slices.
constexpr double told_degrees = 0.1, told_deviation = 1e-3;

struct Placed {
  DicomSlice slice;
  Vec3 position;
  double along = 0;  // the normal
};

class Arranger {
 public:
  Arranger(const std::vector<DicomImage>& images, const DicomGroup& group, const InputSpec& spec,
           const SamePixels& same, VolumeInfo& info)
      : images_(images), group_(group), spec_(spec), same_(same), info_(info) {}

  SliceStack arrange();

 private:
  const DicomImage& image(const DicomSlice& s) const { return images_[s.image]; }
  const FrameFacts& facts(const DicomSlice& s) const { return image(s).frames[s.frame]; }
  const FrameFacts& first() const { return facts(group_.slices.front()); }
  std::string name(const DicomSlice& s) const {
    return image(s).frames.size() == 1
               ? image(s).file.path
               : fmt::format("{}, frame {}", image(s).file.path, s.frame + 1);
  }
  void warn(std::string text) { info_.warnings.push_back(std::move(text)); }

  void settle_plane();
  double assumed_distance();
  SliceStack assumed();
  std::vector<Placed> place() const;
  void drop_duplicates(std::vector<Placed>& placed);
  [[noreturn]] void refuse_duplicates(const std::vector<Placed>& placed, std::size_t begin,
                                      std::size_t end) const;
  void set_geometry(Vec3 z_step, Vec3 origin);
  void tell_tilt(Vec3 step);
  void tell_uneven(const SliceSteps& steps, const std::vector<Placed>& placed);
  void space_evenly(const SliceSteps& steps, const std::vector<Placed>& placed, SliceStack& stack);

  const std::vector<DicomImage>& images_;
  const DicomGroup& group_;
  const InputSpec& spec_;
  const SamePixels& same_;
  VolumeInfo& info_;
  std::array<Vec3, 2> plane_{Vec3{1, 0, 0}, Vec3{0, 1, 0}};  // along rows, down columns
  std::array<double, 2> spacing_{1, 1};                      // along x, along y
  Vec3 normal_{0, 0, 1};
  bool oriented_ = false, measured_ = false;
};

void Arranger::settle_plane() {
  oriented_ = first().orientation.has_value();
  measured_ = first().spacing.has_value();
  if (oriented_) plane_ = *first().orientation;
  normal_ = cross(plane_[0], plane_[1]);
  normal_ = normal_ * (1 / length(normal_));
  const DicomSlice& front = group_.slices.front();
  if (measured_)
    for (std::size_t axis = 0; axis < 2; ++axis)
      spacing_[axis] =
          sound_spacing((*first().spacing)[1 - axis],
                        fmt::format("{}: {}", name(front), tag_text(dicom::pixel_spacing)), info_);
  else
    warn(fmt::format("{}: has no {}: 1 is taken, unless the input's spacing is set", name(front),
                     tag_text(dicom::pixel_spacing)));
  if (image(front).imager_spacing)
    warn(fmt::format("{}: has {} only, which is measured at the detector, not in the patient",
                     name(front), tag_text(dicom::imager_spacing)));
  if (!oriented_)
    warn(fmt::format("{}: has no {}: its axes are taken for those of the world", name(front),
                     tag_text(dicom::orientation)));
}

void Arranger::set_geometry(Vec3 z_step, Vec3 origin) {
  const std::string where = spec_.path;
  set_axes(info_, {plane_[0] * spacing_[0], plane_[1] * spacing_[1], z_step}, where);
  // As written, where lengths of vectors differ in the last digit.
  for (std::size_t axis = 0; axis < 2; ++axis) {
    info_.geometry.spacing[static_cast<int>(axis)] = spacing_[axis];
    info_.geometry.direction[axis] = plane_[axis];
  }
  // Positions are decimals, and so are their distances, but for the arithmetic.
  double& along = info_.geometry.spacing.z;
  if (const double decimal = std::round(along * 1e7) / 1e7; std::abs(decimal - along) < 1e-12)
    along = decimal;
  info_.geometry.origin = origin;
  info_.geometry.unit = measured_ ? "mm" : "";
  info_.geometry.space = oriented_ && first().position ? "LPS" : "";
}

// Of slices whose positions do not tell.
double Arranger::assumed_distance() {
  const FrameFacts& facts_of = first();
  const bool spaced = facts_of.slice_spacing != 0;
  const DicomTag tag = spaced ? dicom::slice_spacing : dicom::slice_thickness;
  const double said = spaced ? facts_of.slice_spacing : facts_of.thickness;
  if (said == 0) {
    warn(
        fmt::format("{}: does not say how far apart slices are: {:g} is taken, unless the input's "
                    "spacing is set",
                    name(group_.slices.front()), spacing_[0]));
    return spacing_[0];
  }
  warn(fmt::format("{}: no positions tell how far apart slices are: {:g} is taken, as {} says",
                   name(group_.slices.front()), said, tag_text(tag)));
  return sound_spacing(said, fmt::format("{}: {}", name(group_.slices.front()), tag_text(tag)),
                       info_);
}

// One slice, or the frames of one file without positions in their order.
SliceStack Arranger::assumed() {
  set_geometry(normal_ * assumed_distance(), first().position.value_or(Vec3{}));
  return {group_.slices, static_cast<std::int64_t>(group_.slices.size()), {}};
}

std::vector<Placed> Arranger::place() const {
  std::vector<Placed> placed;
  for (const DicomSlice& slice : group_.slices) {
    const auto& position = facts(slice).position;
    if (!position)
      throw FormatError(fmt::format(
          "{}: has no {}, so its place among the {} slices is not known: name this file alone, or "
          "a folder of slices with positions",
          name(slice), tag_text(dicom::position), group_.slices.size()));
    placed.push_back({slice, *position, dot(*position, normal_)});
  }
  std::ranges::stable_sort(placed, {}, &Placed::along);
  return placed;
}

void Arranger::refuse_duplicates(const std::vector<Placed>& placed, std::size_t begin,
                                 std::size_t end) const {
  std::string list;
  for (std::size_t i = begin; i < std::min(end, begin + listed_slices); ++i) {
    const std::string& time = facts(placed[i].slice).time;
    list += "\n  " + name(placed[i].slice) + (time.empty() ? "" : ", time " + time);
  }
  if (end - begin > listed_slices)
    list += fmt::format("\n  and {} more", end - begin - listed_slices);
  const Vec3 p = placed[begin].position;
  throw FormatError(fmt::format(
      "{}: {} different slices are at one position ({:g}, {:g}, {:g}): several times, echoes or "
      "reconstructions are no one volume: copy those of one to a folder and name that:{}",
      spec_.path, end - begin, p.x, p.y, p.z, list));
}

void Arranger::drop_duplicates(std::vector<Placed>& placed) {
  const double near = one_place * std::min(spacing_[0], spacing_[1]);
  std::vector<Placed> kept;
  std::string example;
  for (std::size_t begin = 0, end; begin < placed.size(); begin = end) {
    end = begin + 1;
    while (end < placed.size() && placed[end].along - placed[begin].along <= near) ++end;
    const Placed& front = placed[begin];
    for (std::size_t i = begin + 1; i < end; ++i) {
      const FrameFacts &a = facts(front.slice), &b = facts(placed[i].slice);
      const bool same = length(placed[i].position - front.position) <= near && a.slope == b.slope &&
                        a.intercept == b.intercept && a.time == b.time &&
                        same_(front.slice, placed[i].slice);
      if (!same) refuse_duplicates(placed, begin, end);
      if (example.empty()) example = name(placed[i].slice) + " and " + name(front.slice);
    }
    kept.push_back(front);
  }
  if (kept.size() < placed.size())
    warn(
        fmt::format("{}: {} slice{} the same as another at the same position and left out, for "
                    "example {}",
                    spec_.path, placed.size() - kept.size(),
                    placed.size() - kept.size() == 1 ? " is" : "s are", example));
  placed = std::move(kept);
}

void Arranger::tell_tilt(Vec3 step) {
  const double cosine = std::clamp(dot(step, normal_) / length(step), -1.0, 1.0);
  const double degrees = std::acos(cosine) * 180 / std::numbers::pi;
  if (degrees > told_degrees)
    warn(
        fmt::format("{}: slices follow each other {:.2f} degrees off their normal (a tilted "
                    "gantry): the third axis is this slanted step",
                    spec_.path, degrees));
}

void Arranger::tell_uneven(const SliceSteps& steps, const std::vector<Placed>& placed) {
  const Placed &a = placed[steps.widest], &b = placed[steps.widest + 1];
  const std::string where = fmt::format("the largest, {:.4g} mm, between {} and {}", steps.largest,
                                        name(a.slice), name(b.slice));
  const std::string what =
      steps.missing > 0
          ? fmt::format(
                "{} slice{} missing: distances of slices are {:.4g} mm and multiples of "
                "it, {}",
                steps.missing, steps.missing == 1 ? " is" : "s are", steps.middle, where)
          : fmt::format("slices are not equally far apart: {:.4g} to {:.4g} mm, mostly {:.4g}; {}",
                        steps.smallest, steps.largest, steps.middle, where);
  if (spec_.resample != Resample::uniform)
    throw FormatError(fmt::format(
        "{}: {}; add what is missing, or set input.resample = \"uniform\" (--resample uniform) to "
        "interpolate",
        spec_.path, what));
  warn(fmt::format("{}: {}", spec_.path, what));
}

void Arranger::space_evenly(const SliceSteps& steps, const std::vector<Placed>& placed,
                            SliceStack& stack) {
  const double whole = placed.back().along - placed.front().along;
  const double planes = std::floor(whole / steps.distance + 1e-6) + 1;
  if (!(planes <= most_planes * static_cast<double>(placed.size())))
    throw FormatError(fmt::format(
        "{}: the smallest distance of slices is {:g} mm, and evenly that far apart {} slices would "
        "become {:.0f}: remove the slices that are so close to others",
        spec_.path, steps.distance, placed.size(), planes));
  stack.planes = static_cast<std::int64_t>(planes);
  for (const Placed& p : placed)
    stack.at.push_back((p.along - placed.front().along) / steps.distance);
  warn(
      fmt::format("{}: its {} slices are interpolated to {} planes, {:.6g} mm apart; values are "
                  "rounded to the file's integers, halves away from zero",
                  spec_.path, placed.size(), stack.planes, steps.distance));
}

SliceStack Arranger::arrange() {
  settle_plane();
  const DicomImage& one = image(group_.slices.front());
  const bool one_file = std::ranges::all_of(
      group_.slices, [&](const DicomSlice& s) { return s.image == group_.slices.front().image; });
  if (one_file && one.frames.size() > 1 && group_.slices.size() > 1 &&
      !facts(group_.slices[1]).position)
    return assumed();
  if (group_.slices.size() == 1) return assumed();
  std::vector<Placed> placed = place();
  drop_duplicates(placed);
  SliceStack stack;
  stack.planes = static_cast<std::int64_t>(placed.size());
  for (const Placed& p : placed) stack.slices.push_back(p.slice);
  if (placed.size() == 1) {
    set_geometry(normal_ * assumed_distance(), placed.front().position);
    return stack;
  }
  std::vector<Vec3> positions;
  for (const Placed& p : placed) positions.push_back(p.position);
  const SliceSteps steps = examine_steps(positions, normal_);
  if (steps.sideways > steps.tolerance)
    throw FormatError(fmt::format(
        "{}: lies {:.4g} mm beside the line of the other slices of {}: they are no one volume, or "
        "its {} is damaged",
        name(placed[steps.sideways_at].slice), steps.sideways, spec_.path,
        tag_text(dicom::position)));
  if (!steps.even) {
    tell_uneven(steps, placed);
    space_evenly(steps, placed, stack);
  } else if (steps.deviation > told_deviation * steps.distance) {
    warn(
        fmt::format("{}: slices are {:.6g} mm apart on average and lie up to {:.3g} mm off that: "
                    "they are taken as equally far apart",
                    spec_.path, steps.distance, steps.deviation));
  }
  tell_tilt(steps.step);
  set_geometry(steps.step, placed.front().position);
  return stack;
}

}  // namespace

SliceStack arrange_slices(const std::vector<DicomImage>& images, const DicomGroup& group,
                          const InputSpec& spec, const SamePixels& same, VolumeInfo& info) {
  return Arranger(images, group, spec, same, info).arrange();
}

}  // namespace voxweld
