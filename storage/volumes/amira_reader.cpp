#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "storage/support/error.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/amira_header.h"
#include "storage/volumes/axes.h"
#include "storage/volumes/readers.h"

namespace voxweld {
namespace {

Index3 lattice_size(const AmiraHeader& header, const std::string& path) {
  const auto found = header.sizes.find("Lattice");
  if (found == header.sizes.end())
    throw FormatError(path +
                      ": no 'define Lattice': a mesh or lines, not a volume: only lattices are "
                      "supported");
  const std::vector<std::int64_t>& sizes = found->second;
  if (sizes.size() != 3)
    throw FormatError(
        fmt::format("{}: 'define Lattice' has {} sizes: expected three", path, sizes.size()));
  return {sizes[0], sizes[1], sizes[2]};
}

// The box is of the samples' places: its sides are one step shorter than the number of samples.
void place_amira_samples(const AmiraHeader& header, const std::string& path, VolumeInfo& info) {
  if (header.coordinates.empty())
    info.warnings.push_back(path + ": no CoordType: uniform is taken");
  else if (header.coordinates != "uniform")
    throw FormatError(
        fmt::format("{}: CoordType '{}': only uniform lattices are supported: "
                    "resample it first",
                    path, header.coordinates.substr(0, 80)));
  info.geometry.unit = canonical_unit(header.unit);
  if (!header.bounds) {
    info.warnings.push_back(path + ": no BoundingBox: a spacing of 1 is taken");
    return;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(2 * axis);
    const double lo = (*header.bounds)[i], hi = (*header.bounds)[i + 1];
    const std::int64_t steps = std::max<std::int64_t>(1, info.geometry.size[axis] - 1);
    info.geometry.spacing[axis] = sound_spacing(
        (hi - lo) / static_cast<double>(steps),
        fmt::format("{}: BoundingBox along axis {}: {} to {}", path, axis, lo, hi), info);
    if (!std::isfinite(lo))
      throw FormatError(path + ": BoundingBox: the origin is not finite: correct the header");
    info.geometry.origin[axis] = lo;
  }
}

void note_materials(const AmiraHeader& header, const std::string& path, VolumeInfo& info) {
  constexpr std::size_t most_named = 8;
  if (header.materials.empty()) return;
  std::string names;
  for (std::size_t i = 0; i < std::min(most_named, header.materials.size()); ++i)
    names += fmt::format("{}{} {}", i == 0 ? "" : ", ", i, header.materials[i].substr(0, 40));
  if (header.materials.size() > most_named)
    names += fmt::format(" and {} more", header.materials.size() - most_named);
  info.warnings.push_back(
      fmt::format("{}: names of materials are not taken over: {}", path, names));
}

std::unique_ptr<SampleSource> open_amira(const InputSpec& spec) {
  const std::filesystem::path path = spec.path;
  require_input_file(path);
  const ReadFile file(path);
  const AmiraHeader header = read_amira_header(file);
  VolumeInfo info;
  info.format = "amira";
  info.files.push_back({file.path(), file.state()});
  info.geometry.size = lattice_size(header, file.path());
  std::vector<AmiraArray> arrays;
  std::vector<FileArray> listed;
  for (const AmiraArray& array : header.arrays) {
    if (array.of != "Lattice") continue;
    arrays.push_back(array);
    listed.push_back(array.array);
  }
  const AmiraArray& array = arrays[choose_array(listed, {}, spec, info)];
  info.type = *array.array.type;
  const std::string where = fmt::format("{}: array '{}'", file.path(), array.array.selector);
  const std::uint64_t bytes = checked_volume_bytes(info.geometry.size, info.type, where);
  place_amira_samples(header, file.path(), info);
  note_materials(header, file.path(), info);
  DataLayout layout;
  layout.parts = {{.path = path, .offset = find_amira_stream(file, header, array.stream)}};
  layout.encoding = array.encoding;
  if (array.encoding == DataEncoding::raw) layout.parts[0].stored_bytes = bytes;
  if (array.stored_bytes) layout.parts[0].stored_bytes = array.stored_bytes;
  layout.byte_order = header.byte_order;
  layout.named_by = where;
  return open_layout(std::move(info), std::move(layout));
}

Match test_amira(const InputProbe& probe) {
  const std::string_view head(reinterpret_cast<const char*>(probe.head.data()), probe.head.size());
  const std::string first = lower(head.substr(0, std::min<std::size_t>(head.find('\n'), 80)));
  if (first.starts_with("# amiramesh") || first.starts_with("# avizo")) return Match::contents;
  return probe.is_file && probe.extension == ".am" ? Match::extension : Match::none;
}

}  // namespace

VolumeReader amira_reader() {
  return {.name = "amira",
          .files = ".am",
          .test = test_amira,
          .open = open_amira,
          .selects = {Selector::dataset}};
}

}  // namespace voxweld
