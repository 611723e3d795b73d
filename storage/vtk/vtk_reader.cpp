#include <fmt/format.h>

#include <utility>

#include "storage/support/error.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/data_layout.h"
#include "storage/vtk/readers.h"
#include "storage/vtk/vtk_legacy.h"

namespace voxweld {
namespace {

std::unique_ptr<SampleSource> open_vtk(const InputSpec& spec) {
  require_input_file(spec.path);
  const ReadFile file(spec.path);
  LegacyHeader header = read_vtk_legacy(file);
  VolumeInfo info;
  info.format = "vtk";
  info.files.push_back({file.path(), file.state()});
  info.warnings = std::move(header.warnings);
  std::vector<VtkArray> arrays;
  for (const LegacyArray& array : header.arrays) arrays.push_back(array.array);
  const LegacyArray& array =
      header
          .arrays[choose_vtk_array(arrays, header.marked_points, header.marked_cells, spec, info)];
  info.type = *array.array.type;
  info.scale.slope = array.slope;
  place_vtk_samples(header.lattice, array.array, file.path(), info);
  DataLayout layout;
  layout.parts = {
      {.path = file.path(), .offset = array.begin, .stored_bytes = array.end - array.begin}};
  layout.encoding = header.text ? DataEncoding::text : DataEncoding::raw;
  layout.byte_order = std::endian::big;
  layout.named_by = fmt::format("{}: array '{}'", file.path(), array.array.name);
  return open_layout(std::move(info), std::move(layout));
}

Match test_vtk(const InputProbe& probe) {
  const std::string_view head(reinterpret_cast<const char*>(probe.head.data()), probe.head.size());
  if (lower(head.substr(0, 6)) == "# vtk ") return Match::contents;
  return probe.is_file && probe.extension == ".vtk" ? Match::extension : Match::none;
}

}  // namespace

VolumeReader vtk_reader() {
  return {.name = "vtk",
          .files = ".vtk",
          .test = test_vtk,
          .open = open_vtk,
          .selects = {Selector::dataset}};
}

}  // namespace voxweld
