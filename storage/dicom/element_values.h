// Which data elements are kept, and their values as text and numbers.
#pragma once

#include <string>
#include <string_view>

#include "storage/dicom/data_set.h"

namespace voxweld {

bool is_kept(DicomTag tag);
bool is_kept_sequence(DicomTag tag);

// Without the blanks and zeros that fill values to even lengths.
std::string trimmed_value(std::string_view value);

// For messages, which are ASCII: all else is a question mark. At most 64 characters.
std::string shown_text(std::string_view value);

}  // namespace voxweld
