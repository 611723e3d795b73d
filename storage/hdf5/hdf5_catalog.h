// Which datasets of a file may be the volume.
#pragma once

#include <string>
#include <vector>

#include "storage/hdf5/hdf5_dataset.h"
#include "storage/hdf5/hdf5_file.h"
#include "storage/types/volume_reader.h"

namespace voxweld {

// How a dataset was come by, the best way last: the one that is shown.
enum class Way : std::uint8_t { soft_link, hard_link, data_of_group };  // the last: of NeXus

struct CatalogEntry {
  DatasetFacts shape;  // path, type and sizes
  Way way = Way::hard_link;
};

struct Catalog {
  std::vector<CatalogEntry> volumes;  // numbers of three dimensions or more with several samples
  std::vector<std::string> refused;   // others that look like volumes, and why not
  bool cut = false;                   // the file has more objects than were looked at
};

// Walks through all groups, at most 10,000 objects; each dataset once, by whatever links.
// Called under an Hdf5Lock.
Catalog hdf5_catalog(const Hdf5File& file);

// The path of the dataset to read: the one that the spec names, else the only one, or the one that
// the file itself says is its data (NeXus). Adds to info.choices and info.warnings.
// InputError, with a list, where there are none or several.
std::string chosen_dataset(const Hdf5File& file, const InputSpec& spec, VolumeInfo& info);

}  // namespace voxweld
