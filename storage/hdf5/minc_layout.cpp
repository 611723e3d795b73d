#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "storage/hdf5/hdf5_attributes.h"
#include "storage/hdf5/hdf5_layouts.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/axes.h"

namespace voxweld {
namespace {

const std::string image_group = "/minc-2.0/image/0";

// The dimensions in order, slowest first: "zspace,yspace,xspace".
std::vector<std::string> dimension_order(hid_t dataset, std::size_t rank,
                                         const std::string& where) {
  std::string text = text_attribute(dataset, "dimorder").value_or("");
  std::ranges::replace(text, ',', ' ');
  const std::vector<std::string> names = split_words(text);
  if (names.size() == rank) return names;
  throw FormatError(
      fmt::format("{}: dimorder is '{}': expected the names of {} dimensions", where, text, rank));
}

// One letter each, as place_volume takes them.
std::vector<std::string> axis_letters(const std::vector<std::string>& names) {
  std::vector<std::string> letters;
  for (const std::string& name : names)
    letters.push_back(name.ends_with("space") ? name.substr(0, 1) : name == "time" ? "t" : name);
  return letters;
}

struct MincAxis {
  Vec3 direction;
  double step = 1, start = 0;
};

MincAxis read_axis(const Hdf5File& file, const std::string& name, int axis, VolumeInfo& info) {
  MincAxis found;
  found.direction[axis] = 1;
  const std::string path = "/minc-2.0/dimensions/" + name, where = file.path() + ": " + path;
  Hdf5Handle dimension = file.open_dataset(file.id(), path);
  if (!dimension) dimension = file.open_group(file.id(), path);
  if (!dimension) {
    info.warnings.push_back(where + ": is missing; a spacing of 1 is assumed");
    return found;
  }
  const hid_t id = dimension.get();
  if (const auto kind = text_attribute(id, "spacing"); kind && kind->starts_with("irregular"))
    throw FormatError(where + ": its samples are not equally far apart: resample the volume first");
  if (const auto cosines = number_attributes(id, "direction_cosines"); cosines.size() == 3) {
    found.direction = {cosines[0], cosines[1], cosines[2]};
    const double norm = length(found.direction);
    if (!std::isfinite(norm) || norm == 0)
      throw FormatError(where + ": its direction_cosines are no direction");
    found.direction = found.direction * (1 / norm);
  }
  found.start = number_attribute(id, "start").value_or(0);
  const double step = number_attribute(id, "step").value_or(1);
  // Its sign is the direction's; what is no step at all stands for 1.
  found.step = step < 0 && std::isfinite(step) ? step : sound_spacing(step, where, info);
  if (info.geometry.unit.empty())
    info.geometry.unit = canonical_unit(text_attribute(id, "units").value_or(""));
  return found;
}

void read_minc_geometry(const Hdf5File& file, const std::vector<std::string>& names,
                        const VolumePlace& place, VolumeInfo& info) {
  std::array<Vec3, 3> steps;
  Vec3 origin;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const int d = place.dimension[axis];
    const std::string name =
        d < 0 ? std::string(1, "xyz"[a]) + "space" : names[static_cast<std::size_t>(d)];
    const MincAxis found = read_axis(file, name, a, info);
    steps[axis] = found.direction * found.step;
    origin = origin + found.direction * found.start;
  }
  set_axes(info, steps, file.path() + ": /minc-2.0/dimensions");
  if (!std::isfinite(length(origin)))
    throw FormatError(file.path() + ": /minc-2.0/dimensions: a start is not finite");
  info.geometry.origin = origin;
  info.geometry.space = "RAS";
}

// image-min or image-max: one number, or one of each slice, which then all are the same.
std::optional<double> image_bound(const Hdf5File& file, const std::string& name) {
  const std::string path = image_group + "/" + name;
  const Hdf5Handle dataset = file.open_dataset(file.id(), path);
  if (!dataset) return {};
  const auto values = small_dataset(dataset.get(), hsize_t{1} << 20);
  if (!values) return {};
  const auto [lo, hi] = std::ranges::minmax(values->values);
  if (!(hi - lo <= 1e-9 * std::max(std::abs(lo), std::abs(hi))))
    throw FormatError(fmt::format(
        "{}: differs from slice to slice ({} to {}), and so does what a stored number stands for: "
        "write the volume anew with one scale: mincreshape -normalize",
        file.where("dataset", path), lo, hi));
  return values->values.front();
}

// What integers of the type reach to.
std::pair<double, double> type_range(SampleType type) {
  return dispatch_sample_type(type, [](auto tag) {
    using T = typename decltype(tag)::type;
    return std::pair(static_cast<double>(std::numeric_limits<T>::lowest()),
                     static_cast<double>(std::numeric_limits<T>::max()));
  });
}

void read_minc_scale(const Hdf5File& file, const FoundVolume& found, VolumeInfo& info) {
  const SampleType type = *found.facts.type.type;
  if (type == SampleType::f32 || type == SampleType::f64) return;  // these are real as they are
  const auto real_lo = image_bound(file, "image-min"), real_hi = image_bound(file, "image-max");
  if (!real_lo || !real_hi) return;
  auto [lo, hi] = type_range(type);
  if (const auto said = number_attributes(found.dataset.get(), "valid_range"); said.size() == 2)
    lo = std::min(said[0], said[1]), hi = std::max(said[0], said[1]);
  if (!(hi > lo)) return;
  const double slope = (*real_hi - *real_lo) / (hi - lo);
  info.scale = sound_scale(slope, *real_lo - slope * lo,
                           file.path() + ": image-min, image-max, valid_range", info);
}

}  // namespace

std::optional<FoundVolume> minc_volume(const Hdf5File& file, const InputSpec& spec) {
  const std::string path = image_group + "/image", where = file.where("dataset", path);
  if (!file.open_group(file.id(), image_group)) return {};
  if (!spec.select.dataset.empty() && spec.select.dataset != path &&
      "/" + spec.select.dataset != path)
    return {};
  FoundVolume found;
  found.dataset = file.open_dataset(file.id(), path);
  if (!found.dataset) fail_hdf5(where, "cannot be opened");
  found.facts = dataset_facts(file, found.dataset.get(), path);
  const std::vector<std::string> names =
      dimension_order(found.dataset.get(), found.facts.dims.size(), where);
  found.place = place_volume(found.facts, axis_letters(names), spec, where, found.info);
  found.info.geometry.size = size_of(found.facts, found.place);
  read_minc_geometry(file, names, found.place, found.info);
  read_minc_scale(file, found, found.info);
  return found;
}

}  // namespace voxweld
