#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "storage/support/error.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/axes.h"
#include "storage/volumes/data_layout.h"
#include "storage/volumes/readers.h"

namespace voxweld {
namespace {

struct MetaText {
  HeaderFields fields;
  std::vector<std::string> listed;  // the lines after "ElementDataFile = LIST"
  std::uint64_t data_offset = 0;    // where LOCAL samples start
};

// ElementDataFile is the last field: samples or file names follow it.
MetaText read_meta_text(const ReadFile& file) {
  MetaText text{.fields = HeaderFields(file.path()), .listed = {}, .data_offset = 0};
  LineReader lines(file);
  while (const auto line = lines.next()) {
    const std::string_view content = trim(*line);
    if (content.empty()) continue;
    const std::size_t equals = content.find_first_of("=:");
    if (equals == std::string_view::npos)
      throw FormatError(
          fmt::format("{}:{}: expected 'Key = Value': not a MetaImage header, or a "
                      "damaged one",
                      file.path(), lines.line_number()));
    HeaderField field{.key = std::string(trim(content.substr(0, equals))),
                      .value = std::string(trim(content.substr(equals + 1))),
                      .line = lines.line_number()};
    const bool last = field.key == "ElementDataFile";
    const bool listing = last && field.value.starts_with("LIST");
    text.fields.add(std::move(field));
    if (!last) continue;
    text.data_offset = lines.offset();
    while (listing) {
      const auto name = lines.next();
      if (!name) break;
      if (!trim(*name).empty()) text.listed.emplace_back(trim(*name));
    }
    return text;
  }
  throw FormatError(file.path() +
                    ": the header has no field 'ElementDataFile', which must be its last: add it");
}

SampleType meta_type(const HeaderFields& fields) {
  const HeaderField& field = fields.require("ElementType");
  // MET_LONG is 4 bytes in the format, whatever the machine's long is.
  for (const auto& [name, type] : {std::pair{"MET_CHAR", SampleType::i8},
                                   {"MET_UCHAR", SampleType::u8},
                                   {"MET_SHORT", SampleType::i16},
                                   {"MET_USHORT", SampleType::u16},
                                   {"MET_INT", SampleType::i32},
                                   {"MET_UINT", SampleType::u32},
                                   {"MET_LONG", SampleType::i32},
                                   {"MET_ULONG", SampleType::u32},
                                   {"MET_LONG_LONG", SampleType::i64},
                                   {"MET_ULONG_LONG", SampleType::u64},
                                   {"MET_FLOAT", SampleType::f32},
                                   {"MET_DOUBLE", SampleType::f64}})
    if (field.value == name) return type;
  fields.reject(field, "one number a sample: MET_UCHAR, MET_SHORT, MET_FLOAT and the like");
}

// All sizes of the file, 3 and perhaps more of 1.
std::vector<std::int64_t> meta_sizes(const HeaderFields& fields) {
  const HeaderField& ndims = fields.require("NDims");
  const std::int64_t count = fields.integer(ndims);
  if (count < 3 || count > 10) fields.reject(ndims, "3 dimensions (or more of size 1)");
  const HeaderField& field = fields.require("DimSize");
  std::vector<std::int64_t> sizes = fields.integers(field, static_cast<std::size_t>(count));
  for (std::size_t a = 0; a < sizes.size(); ++a) {
    if (sizes[a] < 1) fields.reject(field, "positive sizes");
    if (a >= 3 && sizes[a] != 1)
      fields.fail(field,
                  fmt::format("dimension {} has {} entries: series are not supported, extract "
                              "one volume first",
                              a, sizes[a]));
  }
  return sizes;
}

void read_meta_geometry(const HeaderFields& fields, std::size_t dims, VolumeInfo& info) {
  VolumeGeometry& geometry = info.geometry;
  std::array<Vec3, 3> steps = geometry.direction;
  const HeaderField* matrix = fields.find_any({"TransformMatrix", "Rotation", "Orientation"});
  if (matrix != nullptr) {
    // Numbers d n .. d n + n - 1 are the world direction of axis d, as ITK reads them.
    const std::vector<double> m = fields.reals(*matrix, dims * dims);
    for (std::size_t axis = 0; axis < 3; ++axis)
      steps[axis] = {m[axis * dims], m[axis * dims + 1], m[axis * dims + 2]};
    for (const Vec3& step : steps)
      if (!std::isfinite(length(step)) || length(step) <= 0)
        fields.reject(*matrix, "directions that are finite and not zero");
  }
  const HeaderField* spacing = fields.find_any({"ElementSpacing", "ElementSize"});
  std::vector<double> spacings(dims, 1.0);
  if (spacing != nullptr)
    spacings = fields.reals(*spacing, dims);
  else
    info.warnings.push_back(fields.path() + ": no ElementSpacing: taken as 1 1 1");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (spacing != nullptr)
      spacings[axis] = sound_spacing(
          spacings[axis], fmt::format("{}: axis {}", fields.where(*spacing), axis), info);
    steps[axis] = steps[axis] * (spacings[axis] / length(steps[axis]));
  }
  set_axes(info, steps, matrix != nullptr ? fields.where(*matrix) : fields.path());
  // What was written is taken as it is where no turning changes its digits.
  geometry.spacing = {spacings[0], spacings[1], spacings[2]};
  if (const HeaderField* origin = fields.find_any({"Offset", "Position", "Origin"})) {
    const std::vector<double> at = fields.reals(*origin, dims);
    geometry.origin = {at[0], at[1], at[2]};
    if (!std::isfinite(length(geometry.origin))) fields.reject(*origin, "finite numbers");
  }
  // ITK, which defines the format, reads the transform as one to left, posterior, superior.
  if (matrix != nullptr || fields.find("AnatomicalOrientation") != nullptr) geometry.space = "LPS";
  const HeaderField* unit = fields.find("DistanceUnits");
  if (unit != nullptr && unit->value != "?") geometry.unit = canonical_unit(unit->value);
}

bool flag(const HeaderFields& fields, std::string_view key, bool otherwise) {
  const HeaderField* field = fields.find(key);
  return field != nullptr ? fields.boolean(*field) : otherwise;
}

// Real values are slope * stored + offset.
void read_meta_scale(const HeaderFields& fields, VolumeInfo& info) {
  const auto number = [&](const char* key, double otherwise) {
    const HeaderField* field = fields.find(key);
    return field == nullptr
               ? otherwise
               : parse_real(trim(field->value)).value_or(std::numeric_limits<double>::quiet_NaN());
  };
  info.scale = sound_scale(number("ElementToIntensityFunctionSlope", 1),
                           number("ElementToIntensityFunctionOffset", 0),
                           fields.path() + ": ElementToIntensityFunction", info);
}

std::vector<std::string> data_names(const MetaText& text, const std::vector<std::int64_t>& sizes) {
  const HeaderFields& fields = text.fields;
  const HeaderField& field = fields.require("ElementDataFile");
  const std::vector<std::string> words = split_words(field.value);
  if (words.empty()) fields.reject(field, "a file name, LOCAL or LIST");
  // A slice a file: the volume's third dimension counts them, further ones are 1.
  std::int64_t within = 2;
  if (words[0] == "LIST") {
    if (words.size() > 1) {
      std::string digits = words[1];
      if (digits.back() == 'D') digits.pop_back();
      const auto number = parse_integer(digits);
      if (!number || words.size() > 2) fields.reject(field, "LIST and perhaps a dimension");
      within = *number;
    }
    const std::int64_t expected = expected_files(sizes, within, fields, field);
    if (static_cast<std::int64_t>(text.listed.size()) != expected)
      fields.fail(field, fmt::format("{} files are listed, DimSize needs {}", text.listed.size(),
                                     expected));
    return text.listed;
  }
  const bool pattern = words.size() >= 2 && words[0].find('%') != std::string::npos;
  if (!pattern) return {field.value};
  const std::int64_t expected = expected_files(sizes, within, fields, field);
  std::array<std::int64_t, 3> numbers{1, expected, 1};
  if (words.size() > 4) fields.reject(field, "a pattern and the numbers first, last and step");
  for (std::size_t i = 1; i < words.size(); ++i) {
    const auto number = parse_integer(words[i]);
    if (!number) fields.reject(field, "a pattern and the numbers first, last and step");
    numbers[i - 1] = *number;
  }
  return expand_pattern({words[0], numbers[0], numbers[1], numbers[2]}, expected, fields, field);
}

void read_header_size(const HeaderFields& fields, bool local, DataLayout& layout) {
  const HeaderField* field = fields.find("HeaderSize");
  if (field == nullptr || local) return;
  const std::int64_t bytes = fields.integer(*field);
  if (bytes < -1) fields.reject(*field, "0 or more, or -1 for samples at the file's end");
  if (bytes == -1 && layout.encoding != DataEncoding::raw)
    fields.fail(*field, "-1 has no meaning with compressed or text samples");
  layout.samples_at_end = bytes == -1;
  if (bytes > 0)  // counted in the file, before any decompression
    for (DataLayout::Part& part : layout.parts) part.offset = static_cast<std::uint64_t>(bytes);
}

void check_compressed_size(const HeaderFields& fields, const DataLayout& layout, VolumeInfo& info) {
  const HeaderField* field = fields.find("CompressedDataSize");
  if (field == nullptr || layout.parts.size() != 1) return;
  std::error_code ignored;
  const std::uint64_t size = std::filesystem::file_size(layout.parts[0].path, ignored);
  if (ignored || size < layout.parts[0].offset) return;
  const std::uint64_t actual = size - layout.parts[0].offset;
  if (static_cast<double>(actual) != parse_real(trim(field->value)).value_or(-1))
    info.warnings.push_back(fmt::format("{}: says {} but there are {} bytes: ignored",
                                        fields.where(*field), field->value, actual));
}

DataLayout lay_out(const MetaText& text, const InputSpec& spec, VolumeInfo& info,
                   const std::vector<std::int64_t>& sizes) {
  const HeaderFields& fields = text.fields;
  const std::filesystem::path path = spec.path;
  const HeaderField& data_file = fields.require("ElementDataFile");
  DataLayout layout;
  layout.named_by = fields.where(data_file);
  const bool compressed = flag(fields, "CompressedData", false);
  if (!flag(fields, "BinaryData", true))
    layout.encoding = DataEncoding::text;
  else if (compressed)
    layout.encoding = DataEncoding::deflated;
  const HeaderField* order = fields.find_any({"ElementByteOrderMSB", "BinaryDataByteOrderMSB"});
  if (order != nullptr)
    layout.byte_order = fields.boolean(*order) ? std::endian::big : std::endian::little;
  else if (sample_bytes(info.type) > 1 && layout.encoding != DataEncoding::text)
    info.warnings.push_back(fields.path() + ": no BinaryDataByteOrderMSB: little-endian assumed");
  const bool local =
      data_file.value == "LOCAL" || data_file.value == "Local" || data_file.value == "local";
  if (local) {
    layout.parts = {{path, text.data_offset, 0}};
  } else {
    for (const std::string& name : data_names(text, sizes))
      layout.parts.push_back({named_data_file(spec, name, layout.named_by), 0, 0});
  }
  read_header_size(fields, local, layout);
  if (layout.encoding == DataEncoding::deflated) check_compressed_size(fields, layout, info);
  return layout;
}

Match test_metaimage(const InputProbe& probe) {
  const bool named = probe.extension == ".mha" || probe.extension == ".mhd";
  const auto* text = reinterpret_cast<const char*>(probe.head.data());
  const std::string_view head(text, probe.head.size());
  const std::size_t ndims = head.find("NDims");
  const bool header = ndims != std::string_view::npos &&
                      (head.starts_with("ObjectType") || head.starts_with("NDims")) &&
                      trim(head.substr(ndims + 5)).starts_with('=');
  if (header) return Match::contents;
  return probe.is_file && named ? Match::extension : Match::none;
}

std::unique_ptr<SampleSource> open_metaimage(const InputSpec& spec) {
  const std::filesystem::path path = spec.path;
  require_input_file(path);
  const ReadFile file(path);
  const MetaText text = read_meta_text(file);
  const HeaderFields& fields = text.fields;
  if (const HeaderField* object = fields.find("ObjectType"))
    if (object->value != "Image") fields.reject(*object, "Image");
  if (const HeaderField* channels = fields.find("ElementNumberOfChannels"))
    if (fields.integer(*channels) != 1)
      fields.fail(*channels, fmt::format("{} channels a sample: vectors and colours are not "
                                         "supported, extract one channel first",
                                         channels->value));
  VolumeInfo info;
  info.format = "metaimage";
  info.files.push_back({file.path(), file.state()});
  info.type = meta_type(fields);
  const std::vector<std::int64_t> sizes = meta_sizes(fields);
  info.geometry.size = {sizes[0], sizes[1], sizes[2]};
  read_meta_geometry(fields, sizes.size(), info);
  read_meta_scale(fields, info);
  DataLayout layout = lay_out(text, spec, info, sizes);
  return open_layout(std::move(info), std::move(layout));
}

}  // namespace

VolumeReader metaimage_reader() {
  return {"metaimage", ".mha, .mhd", test_metaimage, open_metaimage};
}

}  // namespace voxweld
