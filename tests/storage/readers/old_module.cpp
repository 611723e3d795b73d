// A module that another version of the program came with.
#include "storage/modules/module_api.h"

const voxweld::ModuleEntry voxweld_module_entry = {"0.0.1/1", nullptr};
