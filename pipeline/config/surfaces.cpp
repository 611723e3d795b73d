#include <utility>

#include "pipeline/config/config.h"

namespace voxweld {

std::vector<OneSurface> surfaces_of(const Config& config) {
  if (config.surface.isovalues.empty()) return {{"", config}};
  std::vector<OneSurface> surfaces;
  for (const IsovalueChoice& choice : config.surface.isovalues) {
    OneSurface one{choice.value ? isovalue_text(*choice.value) : isovalue_rule_name(choice.rule),
                   config};
    one.config.surface.isovalues.clear();
    one.config.surface.isovalue = choice.value;
    one.config.surface.isovalue_rule = choice.rule;
    one.config.output.directory /= "isovalue-" + one.isovalue;
    surfaces.push_back(std::move(one));
  }
  return surfaces;
}

}  // namespace voxweld
