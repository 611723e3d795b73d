// The [[edit]] tables of a config file.
#pragma once

#include "pipeline/config/edit_settings.h"
#include "pipeline/config/item_reader.h"

namespace voxweld {

// The entries of the whole file, which must live as long; `file` names it in messages.
ItemReader<EditConfig, SolidShape> edit_reader(std::span<const DocumentEntry> entries,
                                               std::string file);

}  // namespace voxweld
