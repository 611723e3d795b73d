#include "storage/store/ome_zarr.h"

#include <cmath>

#include "storage/store/zarr_fields.h"
#include "storage/store/zarr_json.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// The group's images, and the file that says so.
struct Images {
  Json document;
  std::string file;
};

std::optional<Images> images_of(const fs::path& group) {
  for (const char* name : {".zattrs", "zarr.json"}) {
    const fs::path path = group / name;
    std::error_code none;
    if (!fs::is_regular_file(path, none)) continue;
    Images images{parse_zarr_document(read_text_file(path), path.string()), path.string()};
    const Json* at = &images.document;
    for (const char* key : {"attributes", "ome"})
      if (at->is_object() && at->contains(key)) at = &at->at(key);
    if (!at->is_object() || !at->contains("multiscales")) continue;
    Json found = at->at("multiscales");
    images.document = std::move(found);
    return images;
  }
  return std::nullopt;
}

std::vector<double> numbers_of(const JsonField& list) {
  std::vector<double> numbers;
  for (const JsonField& number : list.elements()) numbers.push_back(number.real());
  return numbers;
}

// Scales are multiplied, translations scaled and added, in the order in which they are listed.
void apply(const JsonField& holder, OmeDataset& image) {
  if (!holder.has("coordinateTransformations")) return;
  for (const JsonField& step : holder.at("coordinateTransformations").elements()) {
    const std::string type = step.at("type").text();
    if (type == "identity") continue;
    if (type != "scale" && type != "translation")
      step.refuse("\"scale\" or \"translation\" expected, " + step.at("type").shown() + " found");
    const std::vector<double> by = numbers_of(step.at(type.c_str()));
    if (image.scale.empty()) image.scale.assign(by.size(), 1);
    if (image.translation.empty()) image.translation.assign(by.size(), 0);
    if (by.size() != image.scale.size())
      step.refuse(fmt::format("{} numbers expected, {} found", image.scale.size(), by.size()));
    for (std::size_t d = 0; d < by.size(); ++d) {
      if (type == "translation") {
        image.translation[d] += by[d];
        continue;
      }
      image.scale[d] *= by[d];
      image.translation[d] *= by[d];
    }
  }
}

void read_axes(const JsonField& multiscale, OmeDataset& image) {
  if (!multiscale.has("axes")) return;
  for (const JsonField& axis : multiscale.at("axes").elements()) {
    const bool named = axis.value().is_object();  // 0.3 has names alone
    image.axes.push_back(named ? axis.at("name").text() : axis.text());
    image.units.push_back(named && axis.has("unit") ? axis.at("unit").text() : "");
  }
}

std::string short_unit(const std::string& name) {
  static constexpr std::pair<const char*, const char*> units[] = {
      {"meter", "m"},       {"centimeter", "cm"}, {"millimeter", "mm"},
      {"micrometer", "um"}, {"nanometer", "nm"},  {"angstrom", "angstrom"}};
  for (const auto& [long_name, unit] : units)
    if (name == long_name) return unit;
  return {};
}

}  // namespace

std::optional<OmeDataset> ome_dataset_of(const fs::path& array) {
  constexpr int most_levels = 4;
  const fs::path path = fs::absolute(array).lexically_normal();
  fs::path group = path.has_filename() ? path.parent_path() : path.parent_path().parent_path();
  for (int level = 0; level < most_levels && group.has_relative_path(); ++level) {
    if (const auto images = images_of(group)) {
      const std::string within =
          (path.has_filename() ? path : path.parent_path()).lexically_relative(group).string();
      for (const JsonField& multiscale :
           JsonField(images->document, images->file, "multiscales").elements())
        for (const JsonField& dataset : multiscale.at("datasets").elements()) {
          if (dataset.at("path").text() != within) continue;
          OmeDataset image;
          read_axes(multiscale, image);
          apply(dataset, image);
          apply(multiscale, image);
          return image;
        }
    }
    group = group.parent_path();
  }
  return std::nullopt;
}

std::optional<fs::path> full_resolution_of(const fs::path& group) {
  const auto images = images_of(group);
  if (!images) return std::nullopt;
  const auto multiscales = JsonField(images->document, images->file, "multiscales").elements();
  if (multiscales.empty()) return std::nullopt;
  const auto datasets = multiscales[0].at("datasets").elements();
  if (datasets.empty()) return std::nullopt;
  const fs::path within = datasets[0].at("path").text();
  bool inside = within.is_relative();
  for (const auto& part : within) inside = inside && part != "..";
  if (!inside) datasets[0].refuse("a path inside the group expected, " + datasets[0].shown());
  return group / within;
}

ZarrArray read_foreign_array(const fs::path& directory) {
  const fs::path array = full_resolution_of(directory).value_or(directory);
  const auto image = ome_dataset_of(array);
  return read_zarr_array(array, image ? &*image : nullptr);
}

std::optional<VolumeGeometry> geometry_of(const OmeDataset& image, const ZarrArray& array) {
  if (image.scale.size() != array.axes.size()) return std::nullopt;
  VolumeGeometry geometry;
  geometry.size = array.size;
  std::optional<std::string> unit;
  for (std::size_t d = 0; d < array.axes.size(); ++d) {
    const int axis = array.axes[d];
    geometry.spacing[axis] = image.scale[d];
    geometry.origin[axis] = image.translation[d];
    if (!(image.scale[d] > 0) || !std::isfinite(image.scale[d]) ||
        !std::isfinite(image.translation[d]))
      throw FormatError(
          fmt::format("{}: the OME-Zarr group above gives a scale of {} and a "
                      "translation of {}: numbers, and scales above 0, expected",
                      array.path.string(), image.scale[d], image.translation[d]));
    const std::string own = d < image.units.size() ? short_unit(image.units[d]) : "";
    unit = !unit || *unit == own ? own : "";
  }
  geometry.unit = unit.value_or("");
  return geometry;
}

}  // namespace voxweld
