#include "storage/hdf5/hdf5_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "storage/hdf5/hdf5_attributes.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/axes.h"

namespace voxweld {
namespace {

constexpr hsize_t most_places = hsize_t{1} << 22;  // of samples along one axis

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos || slash == 0 ? "/" : path.substr(0, slash);
}

// ["z", "y", "x"], or in one text: "z:y:x", "[z,y,x]".
std::vector<std::string> axes_attribute(hid_t object, std::size_t rank) {
  std::vector<std::string> names = text_attributes(object, "axes");
  if (names.size() == 1 && rank > 1) {
    std::string text = names.front();
    for (char& c : text)
      if (c == ':' || c == ',' || c == '[' || c == ']' || c == '"') c = ' ';
    names = split_words(text);
  }
  if (names.size() != rank) return {};
  for (std::string& name : names)
    if (name == ".") name.clear();
  return names;
}

std::vector<std::string> raw_nexus_axes(const Hdf5File& file, hid_t dataset,
                                        const DatasetFacts& facts) {
  std::vector<std::string> names = axes_attribute(dataset, facts.dims.size());
  const Hdf5Handle group = file.open_group(file.id(), folder_of(facts.path));
  if (names.empty() && group && text_attribute(group.get(), "NX_class") == "NXdata")
    names = axes_attribute(group.get(), facts.dims.size());
  return names;
}

// Where the samples along one dimension lie.
struct AxisPlaces {
  double first = 0, step = 1;
  std::string unit;
};

// Nothing where the group has no such dataset.
std::optional<AxisPlaces> axis_places(const Hdf5File& file, hid_t group, const std::string& name,
                                      std::int64_t count, const InputSpec& spec,
                                      const std::string& where, VolumeInfo& info) {
  if (name.empty()) return {};
  const Hdf5Handle dataset = file.open_dataset(group, name);
  if (!dataset) return {};
  const auto axis = small_dataset(dataset.get(), most_places);
  if (!axis || axis->dims.size() > 1) return {};
  const std::vector<double>& v = axis->values;
  const auto n = static_cast<std::int64_t>(v.size());
  if (n != count && n != count + 1) return {};
  AxisPlaces places{v.front(), n > 1 ? (v.back() - v.front()) / static_cast<double>(n - 1) : 1,
                    canonical_unit(text_attribute(dataset.get(), "units").value_or(""))};
  double largest = 0, worst = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    largest = std::max(largest, std::abs(v[i]));
    const double off = std::abs(v[i] - (places.first + static_cast<double>(i) * places.step));
    worst = off <= worst ? worst : off;  // a NaN too
  }
  // Room for numbers that were rounded to floats.
  const double allowed = std::max(1e-3 * std::abs(places.step), 4e-7 * largest);
  if (!(worst <= allowed) || !std::isfinite(places.step) || places.step == 0) {
    const std::string text = fmt::format(
        "{}: the places of axis '{}' are not equally far apart (step {:g}, off by {:g})", where,
        name, places.step, worst);
    if (!spec.spacing)
      throw FormatError(text + ": resample the volume, or set input.spacing to use another");
    info.warnings.push_back(text);
    return {};
  }
  if (n == count + 1) places.first += places.step / 2;  // these are the edges of samples
  return places;
}

bool from_nexus(const Hdf5File& file, hid_t dataset, const DatasetFacts& facts,
                const VolumePlace& place, const InputSpec& spec, VolumeInfo& info) {
  const std::string where = file.where("dataset", facts.path);
  const std::vector<std::string> names = raw_nexus_axes(file, dataset, facts);
  const Hdf5Handle group = file.open_group(file.id(), folder_of(facts.path));
  if (names.empty() || !group) return false;
  std::array<Vec3, 3> steps{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 origin{0, 0, 0};
  std::vector<std::string> units;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    if (place.dimension[axis] < 0) continue;
    const auto d = static_cast<std::size_t>(place.dimension[axis]);
    const auto found = axis_places(file, group.get(), names[d], facts.dims[d], spec, where, info);
    if (!found) continue;
    steps[axis][a] = found->step;
    origin[a] = found->first;
    units.push_back(found->unit);
  }
  if (units.empty()) return false;
  if (units.size() < 3)
    info.warnings.push_back(where +
                            ": not all of its axes have places; a spacing of 1 is assumed "
                            "along the others: set it in the config");
  if (std::ranges::any_of(units, [&](const auto& unit) { return unit != units.front(); }) &&
      !spec.spacing)
    throw FormatError(
        fmt::format("{}: its axes are in different units ('{}' and others): set "
                    "input.spacing and input.unit",
                    where, units.front()));
  set_axes(info, steps, where);
  info.geometry.origin = origin;
  info.geometry.unit = units.front();
  return true;
}

// The dimensions that are axes of the volume, slowest first.
std::vector<int> axes_in_order(const VolumePlace& place) {
  std::vector<int> axes;
  for (int a = 0; a < 3; ++a)
    if (place.dimension[static_cast<std::size_t>(a)] >= 0) axes.push_back(a);
  std::ranges::sort(axes, {}, [&](int a) { return place.dimension[static_cast<std::size_t>(a)]; });
  return axes;
}

// Three numbers, of z, y and x.
std::optional<Vec3> three_numbers(hid_t dataset, const std::string& name) {
  const std::vector<double> numbers = number_attributes(dataset, name);
  if (numbers.size() != 3) return {};
  return Vec3{numbers[2], numbers[1], numbers[0]};
}

void set_spacing(Vec3 spacing, const std::string& where, VolumeInfo& info) {
  for (int a = 0; a < 3; ++a) info.geometry.spacing[a] = sound_spacing(spacing[a], where, info);
}

// vigra: a resolution of each axis, 0 where it is not known. In no unit that it says.
bool from_axistags(hid_t dataset, const VolumePlace& place, const std::string& where,
                   VolumeInfo& info) {
  const auto text = text_attribute(dataset, "axistags");
  if (!text || text->size() > 65536 || std::ranges::count(*text, '[') > 4) return false;
  const auto document = nlohmann::json::parse(*text, nullptr, false);
  if (!document.is_object() || !document.contains("axes")) return false;
  const auto& tags = document["axes"];
  Vec3 spacing{1, 1, 1};
  for (const int a : axes_in_order(place)) {
    const auto d = static_cast<std::size_t>(place.dimension[static_cast<std::size_t>(a)]);
    if (!tags.is_array() || d >= tags.size() || !tags[d].is_object()) return false;
    const auto found = tags[d].find("resolution");
    if (found == tags[d].end() || !found->is_number() || !(found->get<double>() > 0)) return false;
    spacing[a] = found->get<double>();
  }
  set_spacing(spacing, where + ": axistags", info);
  return true;
}

}  // namespace

std::vector<std::string> nexus_axes(const Hdf5File& file, hid_t dataset,
                                    const DatasetFacts& facts) {
  std::vector<std::string> names = raw_nexus_axes(file, dataset, facts);
  for (std::string& name : names) name = lower(name);
  const Hdf5Handle group = file.open_group(file.id(), folder_of(facts.path));
  bool turned = std::ranges::count(names, "rotation_angle") != 0;
  // NXtomo lays the angles beside the images.
  if (names.empty() && group && !facts.dims.empty()) {
    const Hdf5Handle angles = file.open_dataset(group.get(), "rotation_angle");
    const DatasetFacts shape = angles ? dataset_shape(angles.get(), "") : DatasetFacts{};
    turned = shape.dims.size() == 1 && shape.dims.front() == facts.dims.front();
  }
  if (turned)
    throw FormatError(
        fmt::format("{}: its first dimension is the angle of rotation: these are projections and "
                    "no volume: reconstruct it first",
                    file.where("dataset", facts.path)));
  return names;
}

void read_hdf5_geometry(const Hdf5File& file, hid_t dataset, const DatasetFacts& facts,
                        const VolumePlace& place, const InputSpec& spec, VolumeInfo& info) {
  const std::string where = file.where("dataset", facts.path);
  // Fiji's HDF5 plug-in and ilastik.
  if (const auto size = three_numbers(dataset, "element_size_um")) {
    set_spacing(*size, where + ": element_size_um", info);
    info.geometry.unit = "um";
    return;
  }
  if (from_nexus(file, dataset, facts, place, spec, info)) return;
  if (from_axistags(dataset, place, where, info)) return;
  // CREMI: of datasets in /volumes, in nanometres.
  if (facts.path.starts_with("/volumes/")) {
    if (const auto resolution = three_numbers(dataset, "resolution")) {
      set_spacing(*resolution, where + ": resolution", info);
      info.geometry.origin = three_numbers(dataset, "offset").value_or(Vec3{0, 0, 0});
      info.geometry.unit = "nm";
      return;
    }
  }
  if (!spec.spacing)
    info.warnings.push_back(where +
                            ": says no spacing; 1 x 1 x 1 is assumed, set it in the config");
}

}  // namespace voxweld
