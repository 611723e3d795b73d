// The text part of a NRRD file, checked and turned into plain values.
#pragma once

#include "storage/support/text_fields.h"
#include "storage/types/volume.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {

// The lines of a NRRD header up to the blank line or the end of the file.
struct NrrdText {
  HeaderFields fields;                // keys in lower case, spellings unified ("data file" ...)
  std::vector<std::string> listed;    // the lines after "data file: LIST"
  std::uint64_t data_offset = 0;      // where the samples of an attached header start
  std::vector<std::string> warnings;  // unknown fields
};
// FormatError for lines that are neither field, key/value pair nor comment.
NrrdText read_nrrd_text(const ReadFile& file);

// The axes of the file in order, and which three of them are x, y and z.
struct NrrdAxes {
  std::vector<std::int64_t> sizes;
  std::array<std::size_t, 3> spatial{};  // axis numbers of x, y, z
};
// Refuses by name what is no scalar 3-D volume.
NrrdAxes read_nrrd_axes(const HeaderFields& fields);
// Spacing, directions, origin, unit, space; needs info.geometry for nothing.
void read_nrrd_geometry(const HeaderFields& fields, const NrrdAxes& axes, VolumeInfo& info);

}  // namespace voxweld
