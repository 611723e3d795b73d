// The [[filter]] tables of a config file.
#pragma once

#include "pipeline/config/filter_settings.h"
#include "pipeline/config/item_reader.h"

namespace voxweld {

// The entries of the whole file, which must live as long; `file` names it in messages.
ItemReader<FilterConfig, FilterType> filter_reader(std::span<const DocumentEntry> entries,
                                                   std::string file);

}  // namespace voxweld
