#include <fmt/format.h>

#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "storage/support/error.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/axes.h"
#include "storage/volumes/data_layout.h"
#include "storage/volumes/inflate_stream.h"
#include "storage/volumes/readers.h"

namespace voxweld {
namespace {

constexpr std::string_view family = "#INRIMAGE-", first_word = "#INRIMAGE-4#{", last_line = "##}\n";
constexpr std::size_t header_block_bytes = 256;
constexpr std::size_t most_blocks = 256;

std::string_view text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void check_magic(const std::string& text, const std::string& path) {
  if (text.starts_with(first_word)) return;
  throw FormatError(fmt::format("{}: {}", path,
                                text.starts_with(family)
                                    ? "an Inrimage of another version than 4; convert it first"
                                    : "not an Inrimage: expected #INRIMAGE-4#{ first"));
}

// The header, a whole number of blocks, from the file or from what it decodes to.
std::string read_blocks(const ReadFile& file, bool compressed) {
  std::optional<InflateStream> stream;
  if (compressed) stream.emplace(file, 0);
  std::string text;
  std::vector<std::byte> block;
  for (std::size_t i = 0; i < most_blocks; ++i) {
    const std::uint64_t at = i * header_block_bytes;
    block.resize(stream ? header_block_bytes
                        : std::min<std::uint64_t>(header_block_bytes,
                                                  file.size() - std::min(file.size(), at)));
    if (stream)
      block.resize(stream->read_some(block));
    else
      file.read(at, block);
    text += text_of(block);
    if (i == 0) check_magic(text, file.path());
    if (block.size() < header_block_bytes)
      throw FormatError(
          fmt::format("{}: truncated: the header has no end, ##}} at the end of a block of {} "
                      "bytes; get a complete copy",
                      file.path(), header_block_bytes));
    if (text.ends_with(last_line)) return text;
  }
  throw FormatError(fmt::format("{}: the header has no end within {} bytes: damaged", file.path(),
                                most_blocks * header_block_bytes));
}

HeaderFields read_fields(const std::string& text, const std::string& path) {
  HeaderFields fields(path);
  const std::string_view body = std::string_view(text).substr(
      first_word.size(), text.size() - first_word.size() - last_line.size());
  int number = 0;
  for (std::size_t at = 0; at < body.size();) {
    const std::size_t stop = std::min(body.find('\n', at), body.size());
    const std::string_view line = trim(body.substr(at, stop - at));
    at = stop + 1;
    ++number;
    if (line.empty() || line.front() == '#') continue;
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos)
      throw FormatError(fmt::format("{}:{}: expected KEY=value: a damaged header", path, number));
    fields.add({std::string(trim(line.substr(0, equals))),
                std::string(trim(line.substr(equals + 1))), number});
  }
  return fields;
}

SampleType inr_type(const HeaderFields& fields) {
  const HeaderField& size = fields.require("PIXSIZE");
  const std::vector<std::string> words = split_words(size.value);
  const bool bits_said = words.size() == 2 && (words[1] == "bits" || words[1] == "bit");
  const auto bits =
      words.empty() || (words.size() > 1 && !bits_said) ? std::nullopt : parse_integer(words[0]);
  const HeaderField& type = fields.require("TYPE");
  constexpr std::tuple<const char*, std::int64_t, SampleType> all[] = {
      {"unsigned fixed", 8, SampleType::u8},   {"unsigned fixed", 16, SampleType::u16},
      {"unsigned fixed", 32, SampleType::u32}, {"unsigned fixed", 64, SampleType::u64},
      {"signed fixed", 8, SampleType::i8},     {"signed fixed", 16, SampleType::i16},
      {"signed fixed", 32, SampleType::i32},   {"signed fixed", 64, SampleType::i64},
      {"float", 32, SampleType::f32},          {"float", 64, SampleType::f64}};
  bool named = false;
  for (const auto& [name, its_bits, its_type] : all) {
    if (type.value != name) continue;
    named = true;
    if (bits == its_bits) return its_type;
  }
  if (!named) fields.reject(type, "unsigned fixed, signed fixed or float");
  fields.reject(size, type.value == "float" ? "32 or 64 bits" : "8, 16, 32 or 64 bits");
}

std::endian inr_order(const HeaderFields& fields, VolumeInfo& info) {
  const HeaderField* cpu = fields.find("CPU");
  if (cpu == nullptr) {
    if (sample_bytes(info.type) > 1)
      info.warnings.push_back(fields.path() + ": no CPU: little-endian assumed");
    return std::endian::little;
  }
  if (cpu->value == "decm" || cpu->value == "pc" || cpu->value == "alpha")
    return std::endian::little;
  if (cpu->value == "sun" || cpu->value == "sgi") return std::endian::big;
  fields.reject(*cpu, "decm, pc or alpha (little-endian) or sun or sgi (big-endian)");
}

double number(const HeaderFields& fields, const HeaderField& field) {
  const auto value = parse_real(field.value);
  if (!value || !std::isfinite(*value)) fields.reject(field, "a number");
  return *value;
}

void read_geometry(const HeaderFields& fields, VolumeInfo& info) {
  constexpr const char* sizes[] = {"XDIM", "YDIM", "ZDIM"};
  constexpr const char* steps[] = {"VX", "VY", "VZ"};
  constexpr const char* places[] = {"TX", "TY", "TZ"};
  constexpr const char* turns[] = {"RX", "RY", "RZ"};
  VolumeGeometry& geometry = info.geometry;
  for (int axis = 0; axis < 3; ++axis) {
    const HeaderField& size = fields.require(sizes[axis]);
    geometry.size[axis] = fields.integer(size);
    if (geometry.size[axis] < 1) fields.reject(size, "a positive size");
    if (const HeaderField* step = fields.find(steps[axis])) {
      const auto value = parse_real(step->value);
      if (!value) fields.reject(*step, "a number");
      geometry.spacing[axis] = sound_spacing(*value, fields.where(*step), info);
    } else {
      info.warnings.push_back(fmt::format("{}: no {}: taken as 1", fields.path(), steps[axis]));
    }
    if (const HeaderField* place = fields.find(places[axis]))
      geometry.origin[axis] = number(fields, *place);
    if (const HeaderField* turn = fields.find(turns[axis]); turn && number(fields, *turn) != 0)
      info.warnings.push_back(
          fmt::format("{}: {}: rotations are ignored", fields.where(*turn), turn->value));
  }
}

// "2**-3": real values are the stored ones times that.
void read_inr_scale(const HeaderFields& fields, VolumeInfo& info) {
  const HeaderField* scale = fields.find("SCALE");
  if (scale == nullptr || scale->value.empty()) return;
  const std::string_view text = scale->value;
  const auto power = text.starts_with("2**") ? parse_integer(text.substr(3)) : std::nullopt;
  if (power && *power >= -1000 && *power <= 1000)
    info.scale = value_scale(std::ldexp(1.0, static_cast<int>(*power)), 0);
  else
    info.warnings.push_back(
        fmt::format("{}: {}: expected a power of two such as 2**-3: ignored, values are taken as "
                    "stored",
                    fields.where(*scale), scale->value));
}

Match test_inrimage(const InputProbe& probe) {
  for (const auto* head : {&probe.head, &probe.inflated_head})
    if (text_of(*head).starts_with(family)) return Match::contents;
  const bool named = probe.extension == ".inr" || probe.extension == ".inr.gz";
  return probe.is_file && named ? Match::extension : Match::none;
}

std::unique_ptr<SampleSource> open_inrimage(const InputSpec& spec) {
  const std::filesystem::path path = spec.path;
  require_input_file(path);
  const ReadFile file(path);
  std::vector<std::byte> head(static_cast<std::size_t>(std::min<std::uint64_t>(3, file.size())));
  file.read(0, head);
  const bool compressed = looks_gzip(head);
  const std::string text = read_blocks(file, compressed);
  const HeaderFields fields = read_fields(text, file.path());
  if (const HeaderField* values = fields.find("VDIM"); values && fields.integer(*values) != 1)
    fields.fail(*values, fmt::format("{} values a sample: vectors and colours are not supported, "
                                     "extract one of them first",
                                     values->value));
  VolumeInfo info;
  info.format = "inrimage";
  info.files.push_back({file.path(), file.state()});
  info.type = inr_type(fields);
  read_geometry(fields, info);
  read_inr_scale(fields, info);
  DataLayout layout;
  layout.parts = {{path, 0, 0}};
  layout.encoding = compressed ? DataEncoding::deflated : DataEncoding::raw;
  layout.byte_order = inr_order(fields, info);
  layout.skip_bytes = static_cast<std::int64_t>(text.size());
  layout.named_by = file.path();
  return open_layout(std::move(info), std::move(layout));
}

}  // namespace

VolumeReader inrimage_reader() {
  return {"inrimage", ".inr, .inr.gz", test_inrimage, open_inrimage};
}

}  // namespace voxweld
