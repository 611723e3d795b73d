#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <utility>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/axes.h"
#include "storage/volumes/data_layout.h"
#include "storage/volumes/inflate_stream.h"
#include "storage/volumes/nifti_header.h"
#include "storage/volumes/readers.h"

namespace voxweld {
namespace {

constexpr std::pair<std::int32_t, SampleType> datatypes[] = {
    {2, SampleType::u8},     {4, SampleType::i16},   {8, SampleType::i32},   {16, SampleType::f32},
    {64, SampleType::f64},   {256, SampleType::i8},  {512, SampleType::u16}, {768, SampleType::u32},
    {1024, SampleType::i64}, {1280, SampleType::u64}};
constexpr std::pair<std::int32_t, const char*> refused_datatypes[] = {
    {1, "1-bit"},         {32, "complex64"},    {128, "RGB colour"},   {1536, "128-bit float"},
    {1792, "complex128"}, {2048, "complex256"}, {2304, "RGBA colour"}, {0, "unknown"}};

SampleType nifti_type(const NiftiHeader& header, const std::string& path) {
  for (const auto& [code, type] : datatypes)
    if (code == header.datatype) return type;
  const char* name = "unknown";
  for (const auto& [code, refused] : refused_datatypes)
    if (code == header.datatype) name = refused;
  throw FormatError(
      fmt::format("{}: datatype {} ({}): expected one integer or real number a sample: convert the "
                  "file first",
                  path, header.datatype, name));
}

void check_dimensions(const NiftiHeader& header, const std::string& path) {
  const std::int64_t count = header.dim[0];
  if (count < 3 || count > 7)
    throw FormatError(
        fmt::format("{}: dim[0]: expected a volume of 3 dimensions (or 4 to 7 with sizes of 1), "
                    "found {}",
                    path, count));
  double volumes = 1;  // only its being 1 and the message matter, and it cannot overflow
  for (std::size_t i = 4; i <= static_cast<std::size_t>(count); ++i)
    volumes *= static_cast<double>(std::max<std::int64_t>(1, header.dim[i]));
  if (volumes > 1)
    throw FormatError(
        fmt::format("{}: the file holds {} volumes (dim[4] is {}), one is needed: "
                    "extract one volume first",
                    path, volumes, header.dim[4]));
}

// Direction times spacing of the three axes, and the place of the first sample.
struct Affine {
  std::array<Vec3, 3> steps;
  Vec3 origin;
};

Affine from_sform(const NiftiHeader& header) {
  const auto& row = header.srow;
  Affine affine;
  for (std::size_t a = 0; a < 3; ++a) affine.steps[a] = {row[0][a], row[1][a], row[2][a]};
  affine.origin = {row[0][3], row[1][3], row[2][3]};
  return affine;
}

// The rotation of the unit quaternion (a, b, c, d), of which b, c, d are stored; pixdim[0] < 0
// turns the third axis round.
Affine from_qform(const NiftiHeader& header, Vec3 spacing) {
  double b = header.quatern[0], c = header.quatern[1], d = header.quatern[2];
  double a = 1 - (b * b + c * c + d * d);
  if (a < 1e-7) {  // a turn by half a circle, rounded
    const double scale = 1 / std::sqrt(b * b + c * c + d * d);
    b *= scale, c *= scale, d *= scale;
    a = 0;
  } else {
    a = std::sqrt(a);
  }
  const double handed = header.pixdim[0] < 0 ? -1 : 1;
  return {
      {Vec3{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)} * spacing.x,
       Vec3{2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)} * spacing.y,
       Vec3{2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c} *
           (spacing.z * handed)},
      {header.qoffset[0], header.qoffset[1], header.qoffset[2]}};
}

Vec3 pixdim_spacing(const NiftiHeader& header, const std::string& path, VolumeInfo& info) {
  Vec3 spacing;
  for (int axis = 0; axis < 3; ++axis) {
    spacing[axis] = sound_spacing(header.pixdim[static_cast<std::size_t>(axis) + 1],
                                  fmt::format("{}: pixdim[{}]", path, axis + 1), info);
  }
  return spacing;
}

// How far apart one spacing is that the header says in two ways, of floats, as a share of it. What
// is farther apart moves the far end of an axis: there the transform counts.
constexpr double rounding = 2e-7;

// The two ways a header gives the transform, the sform first, as the readers in the field do.
void read_geometry(const NiftiHeader& header, const std::string& path, VolumeInfo& info) {
  VolumeGeometry& geometry = info.geometry;
  const Vec3 spacing = pixdim_spacing(header, path, info);
  geometry.spacing = spacing;
  const char* form = header.sform_code > 0 ? "sform" : "qform";
  if (header.sform_code <= 0 && header.qform_code <= 0) return;
  const Affine affine = header.sform_code > 0 ? from_sform(header) : from_qform(header, spacing);
  set_axes(info, affine.steps, fmt::format("{}: {}", path, form));
  if (!std::isfinite(length(affine.origin)))
    throw FormatError(fmt::format("{}: {}: the origin is not finite", path, form));
  geometry.origin = affine.origin;
  geometry.space = "RAS";
  for (int axis = 0; axis < 3; ++axis) {
    const double off = std::abs(geometry.spacing[axis] / spacing[axis] - 1);
    if (off <= rounding)  // the digits as written, not as they come back from the matrix
      geometry.spacing[axis] = spacing[axis];
    else if (off > 1e-3)
      info.warnings.push_back(
          fmt::format("{}: axis {}: the {} has spacing {} but pixdim {}: the {} is used", path,
                      axis, form, geometry.spacing[axis], spacing[axis], form));
  }
}

std::string unit_name(std::int32_t units) {
  switch (units & 7) {
    case 1:
      return "m";
    case 2:
      return "mm";
    case 3:
      return "um";
    default:
      return {};
  }
}

// A slope of 0 is the format's way to say that nothing is scaled.
void read_nifti_scale(const NiftiHeader& header, const std::string& path, VolumeInfo& info) {
  info.scale = sound_scale(header.slope, header.inter, path + ": scl_slope, scl_inter", info);
}

std::vector<std::byte> read_header_bytes(const ReadFile& file, bool& compressed) {
  std::vector<std::byte> bytes(
      static_cast<std::size_t>(std::min<std::uint64_t>(nifti2_bytes, file.size())));
  file.read(0, bytes);
  compressed = looks_gzip(bytes);
  if (!compressed) return bytes;
  bytes.resize(nifti2_bytes);
  InflateStream stream(file, 0);
  bytes.resize(stream.read_some(bytes));
  return bytes;
}

// Where the samples start in the decoded single file.
std::int64_t single_file_offset(const NiftiHeader& header, const std::string& path,
                                VolumeInfo& info) {
  const std::size_t header_bytes = header.version == 1 ? nifti1_bytes : nifti2_bytes;
  const auto least = static_cast<double>(header_bytes);
  if (header.vox_offset == 0) {
    info.warnings.push_back(
        fmt::format("{}: vox_offset is 0: samples taken from byte {} on", path, header_bytes + 4));
    return static_cast<std::int64_t>(header_bytes + 4);
  }
  if (!(header.vox_offset >= least && header.vox_offset < 0x1p53) ||
      header.vox_offset != std::floor(header.vox_offset))
    throw FormatError(fmt::format("{}: vox_offset: expected a whole number from {} on, found {}",
                                  path, header_bytes, header.vox_offset));
  return static_cast<std::int64_t>(header.vox_offset);
}

// `path` with another ending, compressed or not; empty when there is no such file.
std::filesystem::path partner(const std::filesystem::path& path, const char* extension) {
  std::filesystem::path stem = path;
  if (lower(stem.extension().string()) == ".gz") stem.replace_extension();
  std::string upper = extension;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (const std::string& ending :
       {std::string(extension), upper, extension + std::string(".gz")}) {
    std::filesystem::path candidate = stem;
    candidate.replace_extension(ending);
    if (std::filesystem::exists(candidate)) return candidate;
  }
  return {};
}

DataLayout lay_out(const NiftiHeader& header, const std::filesystem::path& path, bool compressed,
                   VolumeInfo& info) {
  DataLayout layout;
  layout.byte_order = header.byte_order;
  layout.named_by = path.string();
  if (header.single_file) {
    layout.parts = {{path, 0, 0}};
    layout.skip_bytes = single_file_offset(header, path.string(), info);
  } else {
    const std::filesystem::path data = partner(path, ".img");
    if (data.empty())
      throw FormatError(path.string() +
                        ": the samples are in a file of the same name ending in .img, which is not "
                        "there: put it beside the header");
    layout.parts = {{data, 0, 0}};
    const double offset = header.vox_offset;
    if (!(offset >= 0 && offset < 0x1p53) || offset != std::floor(offset))
      throw FormatError(
          fmt::format("{}: vox_offset: expected a whole number, found {}", path.string(), offset));
    layout.skip_bytes = static_cast<std::int64_t>(offset);
    compressed = lower(data.extension().string()) == ".gz";
  }
  layout.encoding = compressed ? DataEncoding::deflated : DataEncoding::raw;
  return layout;
}

bool is_image_name(const std::string& extension) {
  return extension == ".img" || extension == ".img.gz";
}

bool is_header_name(const std::string& extension) {
  return extension == ".nii" || extension == ".nii.gz" || extension == ".hdr" ||
         extension == ".hdr.gz";
}

Match test_nifti(const InputProbe& probe) {
  if (parse_nifti_header(probe.head) || parse_nifti_header(probe.inflated_head))
    return Match::contents;
  if (looks_analyze(probe.head)) return Match::contents;  // to be refused by name
  if (!probe.is_file) return Match::none;
  if (is_image_name(probe.extension) && !partner(probe.path, ".hdr").empty())
    return Match::extension;
  return is_header_name(probe.extension) ? Match::extension : Match::none;
}

std::unique_ptr<SampleSource> open_nifti(const InputSpec& spec) {
  const std::filesystem::path given = spec.path;
  std::filesystem::path path = given;
  if (is_image_name(name_extension(path))) {
    path = partner(given, ".hdr");
    if (path.empty())
      throw FormatError(given.string() +
                        ": the header, a file of the same name ending in .hdr, is "
                        "not there: put it beside the samples");
  }
  require_input_file(path);
  const ReadFile file(path);
  bool compressed = false;
  const std::vector<std::byte> bytes = read_header_bytes(file, compressed);
  const std::string& name = file.path();
  const std::optional<NiftiHeader> header = parse_nifti_header(bytes);
  if (!header && looks_analyze(bytes))
    throw FormatError(name +
                      ": an Analyze 7.5 header, which leaves the byte order and orientation "
                      "open: convert the file to NIfTI first");
  if (!header)
    throw FormatError(
        fmt::format("{}: not a NIfTI header: expected the magic n+1, ni1, n+2 or ni2 in "
                    "the first {} bytes, the file has {}",
                    name, nifti2_bytes, file.size()));
  VolumeInfo info;
  info.format = "nifti";
  info.files.push_back({name, file.state()});
  info.type = nifti_type(*header, name);
  check_dimensions(*header, name);
  info.geometry.size = {header->dim[1], header->dim[2], header->dim[3]};
  info.geometry.unit = unit_name(header->units);
  read_geometry(*header, name, info);
  read_nifti_scale(*header, name, info);
  if (header->bitpix != static_cast<std::int32_t>(8 * sample_bytes(info.type)))
    info.warnings.push_back(fmt::format("{}: bitpix is {} but datatype {} has {} bits: ignored",
                                        name, header->bitpix, header->datatype,
                                        8 * sample_bytes(info.type)));
  DataLayout layout = lay_out(*header, path, compressed, info);
  return open_layout(std::move(info), std::move(layout));
}

}  // namespace

VolumeReader nifti_reader() {
  return {"nifti", ".nii, .nii.gz, .hdr + .img", test_nifti, open_nifti};
}

}  // namespace voxweld
