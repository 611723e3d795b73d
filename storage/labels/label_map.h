// Tables that say what the labels of a volume stand for.
//
// CSV: a header row names the columns, in any order; separated by commas, semicolons or tabs; cells
// may be in double quotes; lines that begin with # are comments. Columns (letter case, spaces and _
// do not matter):
//   label                a label, or a range "10-20"; needed. Also: id, index, old, value, labelid,
//                        oldid, labelvalue
//   material             the material it becomes part of; -1, or empty with a warning: the label
//                        is left out. Where there is no such column labels stay what they are. Also: new, newid,
//                        materialid, target, group
//   name                 also: labelname, structure, title
//   color                #rrggbb, or red, green and blue of 0 .. 255: "255,0,0". Also: colour, rgb,
//                        hex; or columns r, g, b (red, colorr ...)
//   any other            not looked at, with a warning
// JSON: a list of objects with the keys label, material, name and color, or an object whose keys
// are labels and whose values are such objects, materials (numbers), names (strings), or null: left
// out. Numbers may be in quotes; color is "#rrggbb" or [r, g, b]. 3D Slicer's colour tables and
// FreeSurfer's: lines "label name r g b a". ITK-SNAP's label descriptions: lines "label r g b a
// visible mesh "name"". Both keep labels as they are.
//
// Text is UTF-8, with or without a byte order mark. A label is named once. A material that several
// labels become part of is called what its own label's row says, else what the first row does that
// says something.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "storage/types/material.h"
#include "storage/types/material_table.h"

namespace voxweld {

struct LabelMap {
  std::vector<MaterialRange> entries;  // ascending, disjoint; labels in none are not named
  MaterialTable materials;
  std::vector<std::string> warnings;  // "<path>:<line>: ...", of what may be a slip
};

// Memory: up to label_map_bytes_per_byte for each byte of the file. InputError where there is no
// such file; FormatError "<path>:<line>: ...", the line being the one the entry begins in;
// StorageError.
LabelMap read_label_map(const std::filesystem::path& path);
inline constexpr std::uint64_t label_map_bytes_per_byte = 32;

// The same for a text at hand; `path` names it in messages and its ending tells the format.
LabelMap parse_label_map(std::string_view text, const std::filesystem::path& path);

}  // namespace voxweld
