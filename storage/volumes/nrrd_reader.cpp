#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "storage/support/error.h"
#include "storage/volumes/nrrd_header.h"
#include "storage/volumes/readers.h"

namespace voxweld {
namespace {

SampleType nrrd_type(const HeaderFields& fields) {
  const HeaderField& field = fields.require("type");
  const std::string name = lower(trim(field.value));
  if (name == "block") fields.fail(field, "'block' samples are opaque: only numbers are supported");
  for (const auto& [spelling, type] : {std::pair{"short int", SampleType::i16},
                                       {"signed short", SampleType::i16},
                                       {"signed short int", SampleType::i16},
                                       {"unsigned short int", SampleType::u16},
                                       {"signed int", SampleType::i32},
                                       {"longlong", SampleType::i64},
                                       {"long long", SampleType::i64},
                                       {"long long int", SampleType::i64},
                                       {"signed long long", SampleType::i64},
                                       {"signed long long int", SampleType::i64},
                                       {"int64_t", SampleType::i64},
                                       {"ulonglong", SampleType::u64},
                                       {"unsigned long long", SampleType::u64},
                                       {"unsigned long long int", SampleType::u64},
                                       {"uint64_t", SampleType::u64},
                                       {"int8_t", SampleType::i8}})
    if (name == spelling) return type;
  // Plain "char" means nothing certain and is no type of the format.
  if (const auto type = parse_sample_type(name); type && name != "char") return *type;
  fields.reject(field, "a type of the format (unsigned char, short, float ...)");
}

DataEncoding nrrd_encoding(const HeaderFields& fields) {
  const HeaderField& field = fields.require("encoding");
  const std::string name = lower(trim(field.value));
  if (name == "raw") return DataEncoding::raw;
  if (name == "gz" || name == "gzip") return DataEncoding::deflated;
  if (name == "bz2" || name == "bzip2") return DataEncoding::bzip2;
  if (name == "txt" || name == "text" || name == "ascii") return DataEncoding::text;
  fields.fail(field, fmt::format("encoding '{}' is not supported: rewrite the file as raw or gzip "
                                 "(supported: raw, gzip, bzip2, ascii)",
                                 name.substr(0, 40)));
}

std::endian nrrd_byte_order(const HeaderFields& fields, SampleType type, DataEncoding encoding) {
  if (sample_bytes(type) == 1 || encoding == DataEncoding::text) return std::endian::native;
  const HeaderField& field = fields.require("endian");
  const std::string name = lower(trim(field.value));
  if (name == "little") return std::endian::little;
  if (name == "big") return std::endian::big;
  fields.reject(field, "little or big");
}

// How many files share the samples, of which `named` are named. `within`: dimensions a file. With as
// many as the volume has, each holds the same number of slices.
std::int64_t files_needed(const NrrdAxes& axes, std::int64_t within, std::int64_t named,
                          const HeaderFields& fields, const HeaderField& field) {
  if (within != static_cast<std::int64_t>(axes.sizes.size()))
    return expected_files(axes.sizes, within, fields, field);
  if (named < 1 || named > max_files || axes.sizes.back() % named != 0)
    fields.fail(field,
                fmt::format("{} files cannot share {} slices evenly", named, axes.sizes.back()));
  return named;
}

// Of the numbers first, last and step; 0 where the step is 0 or leads away.
std::int64_t numbers_between(const std::vector<std::int64_t>& numbers) {
  const double span = static_cast<double>(numbers[1]) - static_cast<double>(numbers[0]);
  const double count = std::floor(span / static_cast<double>(numbers[2])) + 1;
  return count >= 1 && count <= static_cast<double>(max_files) ? static_cast<std::int64_t>(count)
                                                               : 0;
}

std::vector<std::string> pattern_names(const HeaderFields& fields, const HeaderField& field,
                                       const NrrdAxes& axes) {
  const std::vector<std::string> words = split_words(field.value);
  std::vector<std::int64_t> numbers;
  for (std::size_t i = 1; i < words.size(); ++i) {
    const auto number = parse_integer(words[i]);
    if (!number) fields.reject(field, "a pattern and the numbers first, last and step");
    numbers.push_back(*number);
  }
  if (numbers.size() != 3 && numbers.size() != 4)
    fields.reject(field, "a pattern and the numbers first, last and step");
  const auto dimension = static_cast<std::int64_t>(axes.sizes.size());
  const std::int64_t within = numbers.size() == 4 ? numbers[3] : dimension - 1;
  return expand_pattern({words[0], numbers[0], numbers[1], numbers[2]},
                        files_needed(axes, within, numbers_between(numbers), fields, field), fields,
                        field);
}

std::vector<std::string> listed_names(const NrrdText& text, const HeaderField& field,
                                      const NrrdAxes& axes) {
  const HeaderFields& fields = text.fields;
  const std::vector<std::string> words = split_words(field.value);
  const auto dimension = static_cast<std::int64_t>(axes.sizes.size());
  std::int64_t within = dimension - 1;
  if (words.size() == 2) {
    const auto number = parse_integer(words[1]);
    if (!number) fields.reject(field, "LIST and perhaps a number of dimensions");
    within = *number;
  } else if (words.size() > 2) {
    fields.reject(field, "LIST and perhaps a number of dimensions");
  }
  const std::int64_t expected =
      files_needed(axes, within, static_cast<std::int64_t>(text.listed.size()), fields, field);
  if (static_cast<std::int64_t>(text.listed.size()) != expected)
    fields.fail(
        field, fmt::format("{} files are listed, the sizes need {}", text.listed.size(), expected));
  return text.listed;
}

// A file name may hold blanks: it is a pattern only where a % and numbers say so.
bool is_pattern(const std::string& value) {
  const std::vector<std::string> words = split_words(value);
  return words.size() >= 2 && words[0].find('%') != std::string::npos;
}

void lay_out_parts(const NrrdText& text, const NrrdAxes& axes, const InputSpec& spec,
                   DataLayout& layout) {
  const HeaderFields& fields = text.fields;
  const std::filesystem::path path = spec.path;
  const HeaderField* data_file = fields.find("data file");
  const HeaderField* line_skip = fields.find("line skip");
  const std::int64_t lines = line_skip != nullptr ? fields.integer(*line_skip) : 0;
  if (lines < 0 || lines > 1'000'000) fields.reject(*line_skip, "a number from 0 to 1000000");
  const int skip = static_cast<int>(lines);
  layout.named_by = data_file != nullptr ? fields.where(*data_file) : path.string();
  if (data_file == nullptr) {
    layout.parts = {{path, text.data_offset, skip}};
    return;
  }
  std::vector<std::string> names = {data_file->value};
  if (split_words(data_file->value).empty()) fields.reject(*data_file, "a file name");
  if (data_file->value.starts_with("LIST"))
    names = listed_names(text, *data_file, axes);
  else if (is_pattern(data_file->value))
    names = pattern_names(fields, *data_file, axes);
  for (const std::string& name : names)
    layout.parts.push_back({named_data_file(spec, name, layout.named_by), 0, skip});
}

void read_byte_skip(const HeaderFields& fields, DataLayout& layout) {
  const HeaderField* field = fields.find("byte skip");
  if (field == nullptr) return;
  const std::int64_t bytes = fields.integer(*field);
  layout.samples_at_end = bytes == -1;
  layout.skip_bytes = layout.samples_at_end ? 0 : bytes;
  if (bytes < -1) fields.reject(*field, "0 or more, or -1 for samples at the file's end");
  if (bytes == -1 && layout.encoding == DataEncoding::text)
    fields.fail(*field, "-1 has no meaning with text samples");
}

Match test_nrrd(const InputProbe& probe) {
  const auto* head = reinterpret_cast<const char*>(probe.head.data());
  if (std::string_view(head, probe.head.size()).starts_with("NRRD")) return Match::contents;
  const bool named = probe.extension == ".nrrd" || probe.extension == ".nhdr";
  return probe.is_file && named ? Match::extension : Match::none;
}

std::unique_ptr<SampleSource> open_nrrd(const InputSpec& spec) {
  const std::filesystem::path path = spec.path;
  require_input_file(path);
  const ReadFile file(path);
  NrrdText text = read_nrrd_text(file);
  VolumeInfo info;
  info.format = "nrrd";
  info.warnings = std::move(text.warnings);
  info.files.push_back({file.path(), file.state()});
  info.type = nrrd_type(text.fields);
  for (const char* key : {"old min", "old max"})
    if (const HeaderField* field = text.fields.find(key))
      info.warnings.push_back(fmt::format(
          "{}: the samples stand for a real range: ignored, the isovalue is in stored units",
          text.fields.where(*field)));
  const NrrdAxes axes = read_nrrd_axes(text.fields);
  read_nrrd_geometry(text.fields, axes, info);
  // Before the parts are counted: their number is bounded by the sizes.
  checked_volume_bytes(info.geometry.size, info.type,
                       text.fields.where(text.fields.require("sizes")));
  DataLayout layout;
  layout.encoding = nrrd_encoding(text.fields);
  layout.byte_order = nrrd_byte_order(text.fields, info.type, layout.encoding);
  lay_out_parts(text, axes, spec, layout);
  read_byte_skip(text.fields, layout);
  return open_layout(std::move(info), std::move(layout));
}

}  // namespace

VolumeReader nrrd_reader() {
  return {"nrrd", ".nrrd, .nhdr", test_nrrd, open_nrrd};
}

}  // namespace voxweld
