// Loads the image module on first use.
#pragma once

#include "storage/image/module_api.h"

namespace voxweld {

// The module, loaded on the first call from any thread and never unloaded. It is looked for in
// $VOXWELD_MODULE_DIR, beside the program, and in ../lib/voxweld from there.
// Throws InputError, naming where it was looked for, when it is missing or of another build.
ImageModule& image_module();

// True once image_module() succeeded: whether this process pays for OpenImageIO.
bool image_module_loaded();

}  // namespace voxweld
