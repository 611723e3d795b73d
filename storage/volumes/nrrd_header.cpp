#include "storage/volumes/nrrd_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::string_view known_fields[] = {"type",
                                             "dimension",
                                             "sizes",
                                             "encoding",
                                             "endian",
                                             "content",
                                             "block size",
                                             "min",
                                             "max",
                                             "old min",
                                             "old max",
                                             "data file",
                                             "line skip",
                                             "byte skip",
                                             "number",
                                             "sample units",
                                             "spacings",
                                             "thicknesses",
                                             "axis mins",
                                             "axis maxs",
                                             "centers",
                                             "centerings",
                                             "labels",
                                             "units",
                                             "kinds",
                                             "space",
                                             "space dimension",
                                             "space units",
                                             "space origin",
                                             "space directions",
                                             "measurement frame"};

// Fields may be written with or without their blank ("datafile").
std::string unified_name(std::string_view name) {
  const std::string text = lower(trim(name));
  for (const std::string_view known : known_fields) {
    std::string joined(known);
    std::erase(joined, ' ');
    if (text == joined) return std::string(known);
  }
  return text;
}

bool is_known(std::string_view name) {
  return std::ranges::find(known_fields, name) != std::end(known_fields);
}

void read_magic(LineReader& lines, const std::string& path) {
  const auto magic = lines.next();
  if (!magic || !magic->starts_with("NRRD"))
    throw FormatError(path + ":1: not a NRRD file: the first line must be NRRD000X");
  const std::string_view version = trim(std::string_view(*magic).substr(4));
  if (version != "00.01" && (version < "0001" || version > "0005" || version.size() != 4))
    throw FormatError(fmt::format(
        "{}:1: NRRD version '{}' is not known: supported are NRRD0001 to NRRD0005", path, version));
}

}  // namespace

NrrdText read_nrrd_text(const ReadFile& file) {
  NrrdText text{
      .fields = HeaderFields(file.path()), .listed = {}, .data_offset = 0, .warnings = {}};
  LineReader lines(file);
  read_magic(lines, file.path());
  bool listing = false;
  while (const auto line = lines.next()) {
    const std::string_view content = *line;
    if (listing) {
      if (!trim(content).empty()) text.listed.emplace_back(trim(content));
      continue;
    }
    if (content.empty()) break;
    if (content.front() == '#') continue;
    const std::size_t colon = content.find(':');
    if (colon == std::string_view::npos)
      throw FormatError(fmt::format(
          "{}:{}: expected 'field: value', 'key:=value', a comment or a blank line: the "
          "header is damaged or its end is missing",
          file.path(), lines.line_number()));
    if (content.substr(colon).starts_with(":="))
      continue;  // free key/value pairs say nothing to us
    HeaderField field{.key = unified_name(content.substr(0, colon)),
                      .value = std::string(trim(content.substr(colon + 1))),
                      .line = lines.line_number()};
    if (!is_known(field.key))
      text.warnings.push_back(fmt::format("{}: unknown field ignored", text.fields.where(field)));
    listing = field.key == "data file" && field.value.starts_with("LIST");
    text.fields.add(std::move(field));
  }
  text.data_offset = lines.offset();
  return text;
}

}  // namespace voxweld
