// Finds modules and loads them on first use.
#pragma once

#include <memory>
#include <string>

#include "storage/modules/module_api.h"

namespace voxweld {

// The module in libvoxweld_NAME.so, loaded on the first call from any thread and never unloaded. It
// is looked for in $VOXWELD_MODULES, beside the program, and in ../lib/voxweld from there.
// `purpose` is for messages and reads after "needed to".
// Throws InputError, naming where it was looked for, when it is missing or of another build.
Module& load_module(const std::string& name, const std::string& purpose);

// What the module says, as the program throws it.
[[noreturn]] void raise_module_error(const ModuleError& error);

// Opens the input by the reader of that name in its module.
// InputError when there is no such module, or it has no such reader; else what the reader says.
// Precondition: reader.module is not empty.
std::unique_ptr<SampleSource> open_by_module(const VolumeReader& reader, const InputSpec& spec);

}  // namespace voxweld
