#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "storage/support/error.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/axes.h"
#include "storage/volumes/data_layout.h"
#include "storage/volumes/inflate_stream.h"
#include "storage/volumes/mrc_header.h"
#include "storage/volumes/readers.h"
#include "storage/volumes/transposed_source.h"

namespace voxweld {
namespace {

constexpr std::int32_t first_stack_group = 401;
constexpr std::int32_t first_known_version = 20140;

// Bytes were unsigned in old files; which they are IMOD says, and the format since 2014.
SampleType byte_type(const MrcHeader& header, const std::string& path, VolumeInfo& info) {
  if (header.of_imod) return (header.imod_flags & 1) != 0 ? SampleType::i8 : SampleType::u8;
  if (header.version >= first_known_version) return SampleType::i8;
  if (header.lowest < header.highest) {
    if (header.lowest < 0) return SampleType::i8;
    return header.highest > 127 ? SampleType::u8 : SampleType::i8;
  }
  info.warnings.push_back(path +
                          ": the file does not say whether its bytes are signed: taken as signed");
  return SampleType::i8;
}

SampleType mrc_type(const MrcHeader& header, const std::string& path, VolumeInfo& info) {
  constexpr std::pair<std::int32_t, const char*> refused[] = {
      {3, "complex integers"},   {4, "complex floats"}, {5, "bytes in integers"},
      {12, "floats of 16 bits"}, {16, "colours"},       {101, "integers of 4 bits"}};
  switch (header.mode) {
    case 0:
      return byte_type(header, path, info);
    case 1:
      return SampleType::i16;
    case 2:
      return SampleType::f32;
    case 6:
      return SampleType::u16;
    default:
      break;
  }
  const char* name = "unknown";
  for (const auto& [mode, text] : refused)
    if (mode == header.mode) name = text;
  throw FormatError(
      fmt::format("{}: byte 12: mode {} ({}): expected 0, 1, 2 or 6, integers of 8 or 16 bits or "
                  "floats of 32: convert the file first",
                  path, header.mode, name));
}

// Unit vectors along the cell's sides: the first along x, the second in the plane of x and y.
std::array<Vec3, 3> cell_axes(const MrcHeader& header, const std::string& path) {
  const auto right = [](float angle) { return angle == 90 || angle == 0; };
  if (std::ranges::all_of(header.angles, right))
    return {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  std::array<double, 3> cosine{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = header.angles[i];
    if (!(angle > 0 && angle < 180))
      throw FormatError(
          fmt::format("{}: byte {}: an angle of {} degrees in the cell: expected more "
                      "than 0 and less than 180: correct the header",
                      path, 52 + 4 * i, angle));
    cosine[i] = right(header.angles[i]) ? 0 : std::cos(angle * std::numbers::pi / 180);
  }
  const double sine = std::sqrt(1 - cosine[2] * cosine[2]);
  const double y = (cosine[0] - cosine[1] * cosine[2]) / sine;
  const double z = std::sqrt(std::max(0.0, 1 - cosine[1] * cosine[1] - y * y));
  return {Vec3{1, 0, 0}, Vec3{cosine[2], sine, 0}, Vec3{cosine[1], y, z}};
}

double mrc_spacing(const MrcHeader& header, std::size_t axis, const std::string& path,
                   VolumeInfo& info) {
  constexpr const char* names = "XYZ";
  const double cell = header.cell[axis];
  const auto where = fmt::format("{}: cell along {}", path, names[axis]);
  if (header.grid[axis] > 0 && cell != 0)
    return sound_spacing(cell / header.grid[axis], where, info);
  info.warnings.push_back(
      fmt::format("{}: {} angstrom in {} intervals: a spacing of 1 is taken: set the spacing if "
                  "that is wrong",
                  where, cell, header.grid[axis]));
  return 1;
}

// along[i]: which of x, y, z columns, rows and sections run along.
void read_mrc_geometry(const MrcHeader& header, const std::array<int, 3>& along,
                       const std::string& path, VolumeInfo& info) {
  VolumeGeometry& geometry = info.geometry;
  geometry.unit = "angstrom";
  std::array<Vec3, 3> steps = cell_axes(header, path);
  Vec3 spacing;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    geometry.size[along[i]] = header.size[i];
    spacing[axis] = mrc_spacing(header, i, path, info);
    steps[i] = steps[i] * spacing[axis];
  }
  set_axes(info, steps, path + ": cell");
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(geometry.spacing[axis] / spacing[axis] - 1) < 1e-9)
      geometry.spacing[axis] = spacing[axis];
  // Programs write one of the two or both; the origin is what readers of the field go by first.
  const Vec3 origin{header.origin[0], header.origin[1], header.origin[2]};
  Vec3 start;
  for (std::size_t i = 0; i < 3; ++i)
    start = start + steps[static_cast<std::size_t>(along[i])] * header.start[i];
  const bool usable = std::isfinite(length(origin));
  if (!usable)
    info.warnings.push_back(path + ": byte 196: an origin that is not finite is ignored");
  const bool given = usable && length(origin) > 0;
  geometry.origin = given ? origin : start;
  if (given && length(start) > 0 && length(start + origin * -1) > 1e-3 * length(origin))
    info.warnings.push_back(
        fmt::format("{}: the first sample lies at {:g}, {:g}, {:g} by ORIGIN (byte 196) and {:g}, "
                    "{:g}, {:g} by "
                    "NXSTART and so on (byte 16): the former is taken",
                    path, origin.x, origin.y, origin.z, start.x, start.y, start.z));
}

std::vector<std::byte> read_mrc_bytes(const ReadFile& file, bool& compressed) {
  std::vector<std::byte> bytes(
      static_cast<std::size_t>(std::min<std::uint64_t>(mrc_header_bytes, file.size())));
  file.read(0, bytes);
  compressed = looks_gzip(bytes);
  if (!compressed) return bytes;
  bytes.resize(mrc_header_bytes);
  InflateStream stream(file, 0);
  bytes.resize(stream.read_some(bytes));
  return bytes;
}

MrcHeader read_mrc_header(const ReadFile& file, bool& compressed) {
  const std::vector<std::byte> bytes = read_mrc_bytes(file, compressed);
  if (bytes.size() < mrc_header_bytes)
    throw FormatError(
        fmt::format("{}: truncated: {} bytes, where an MRC header has {}: get a "
                    "complete copy",
                    file.path(), bytes.size(), mrc_header_bytes));
  const auto header = parse_mrc_header(bytes);
  if (!header)
    throw FormatError(
        fmt::format("{}: not an MRC header: sizes (byte 0), mode (12), axes (64) and "
                    "length of the extended header (92) make no sense in either byte "
                    "order",
                    file.path()));
  return *header;
}

void check_mrc_kind(const MrcHeader& header, const std::string& path, VolumeInfo& info) {
  if (header.space_group >= first_stack_group)
    throw FormatError(
        fmt::format("{}: byte 88: space group {}: a stack of volumes: extract one "
                    "volume first",
                    path, header.space_group));
  if (header.space_group == 0 && header.grid[2] == 1 && header.size[2] > 1)
    info.warnings.push_back(
        path +
        ": the header calls this a stack of images, not a volume: read as the slices of one");
  if (!header.has_map)
    info.warnings.push_back(path +
                            ": no MAP at byte 208, as in old files: read as if it were there");
  if (!header.stamped)
    info.warnings.push_back(
        fmt::format("{}: byte 212: no machine stamp that fits: {}-endian by the sizes", path,
                    header.byte_order == std::endian::little ? "little" : "big"));
}

std::unique_ptr<SampleSource> open_mrc(const InputSpec& spec) {
  const std::filesystem::path path = spec.path;
  require_input_file(path);
  const ReadFile file(path);
  bool compressed = false;
  const MrcHeader header = read_mrc_header(file, compressed);
  VolumeInfo info;
  info.format = "mrc";
  info.files.push_back({file.path(), file.state()});
  check_mrc_kind(header, file.path(), info);
  info.type = mrc_type(header, file.path(), info);
  const std::array<int, 3> along{header.axes[0] - 1, header.axes[1] - 1, header.axes[2] - 1};
  read_mrc_geometry(header, along, file.path(), info);
  DataLayout layout;
  layout.parts = {{path, 0, 0}};
  layout.encoding = compressed ? DataEncoding::deflated : DataEncoding::raw;
  layout.byte_order = header.byte_order;
  layout.skip_bytes = static_cast<std::int64_t>(mrc_header_bytes) + header.extended_bytes;
  layout.named_by = file.path();
  if (along == std::array{0, 1, 2}) return open_layout(std::move(info), std::move(layout));
  if (compressed)
    throw FormatError(fmt::format(
        "{}: byte 64: columns, rows and sections run along axes {}, {}, {}: of such files only "
        "those that are not compressed can be read: decompress it with gunzip",
        file.path(), header.axes[0], header.axes[1], header.axes[2]));
  VolumeInfo stored;  // as it lies in the file
  stored.format = info.format;
  stored.type = info.type;
  stored.geometry.size = {header.size[0], header.size[1], header.size[2]};
  stored.files = info.files;
  std::shared_ptr<SampleSource> source = open_layout(std::move(stored), std::move(layout));
  const std::vector<std::string>& said = source->info().warnings;
  info.warnings.insert(info.warnings.end(), said.begin(), said.end());
  return transposed_source(std::move(source), along, std::move(info));
}

Match test_mrc(const InputProbe& probe) {
  for (const auto* head : {&probe.head, &probe.inflated_head})
    if (const auto header = parse_mrc_header(*head); header && header->has_map)
      return Match::contents;
  std::string ending = probe.extension;
  if (ending.ends_with(".gz")) ending.resize(ending.size() - 3);
  constexpr const char* endings[] = {".mrc", ".map", ".rec", ".ccp4", ".st"};
  const bool named = std::ranges::find(endings, ending) != std::end(endings);
  return probe.is_file && named ? Match::extension : Match::none;
}

}  // namespace

VolumeReader mrc_reader() {
  return {"mrc", ".mrc, .map, .rec, .ccp4, .st, each also with .gz", test_mrc, open_mrc};
}

}  // namespace voxweld
