// A module made of readers like those of the program. For modules only.
#pragma once

#include <utility>
#include <vector>

#include "storage/modules/module_api.h"

namespace voxweld {

// Carries what the readers and their sources throw over the border. Of a row only the name and
// `open` are looked at: to detect an input is up to the table, which must not load the module.
class ReaderModule : public Module {
 public:
  explicit ReaderModule(std::vector<VolumeReader> rows) : rows_(std::move(rows)) {}

  std::vector<std::string> readers() const override;
  ModuleVolume* open_volume(const std::string& reader, const InputSpec& spec,
                            ModuleError& error) override;

 private:
  std::vector<VolumeReader> rows_;
};

}  // namespace voxweld
