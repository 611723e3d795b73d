// What the tags of a TIFF page say, for the module only.
#pragma once

#include "storage/image/image_page.h"
#include "storage/image/tiff_directories.h"
#include "storage/image/tiff_file.h"
#include "storage/image/tiff_reader.h"

namespace voxweld {

// Of the file's current directory. FormatError, without the file's name, for what is not supported
// and for sizes that the file cannot hold.
TiffLayout tiff_layout(const TiffFile& file);
ImagePage tiff_page_facts(const TiffFile& file, const TiffLayout& layout);

}  // namespace voxweld
