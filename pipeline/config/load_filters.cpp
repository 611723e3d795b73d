#include "pipeline/config/load_filters.h"

#include <algorithm>
#include <utility>

namespace voxweld {
namespace {

void check_median(const WrittenItem& filter, const FilterConfig& config) {
  const Index3 r = config.radius;
  if (config.type != FilterType::median || std::max({r.x, r.y, r.z}) <= most_median_radius) return;
  const DocumentEntry& radius = *filter.find("radius");
  filter.fail(radius.value_at, fmt::format("radius: expected at most {} of a median, found {}",
                                           most_median_radius, to_toml(radius.value)));
}

// The greatest of some samples and the most frequent are samples themselves.
void check_method(const WrittenItem& filter, const FilterConfig& config) {
  if (config.type != FilterType::downsample || config.method == FilterConfig::Method::mean) return;
  const DocumentEntry* type = filter.find("sample_type");
  if (type == nullptr) return;
  filter.fail(type->value_at,
              fmt::format("sample_type = {}: with method = {} samples keep their type; remove it",
                          to_toml(type->value), to_toml(filter.find("method")->value)));
}

void check_filter(const WrittenItem& filter, const FilterConfig& config) {
  check_median(filter, config);
  check_method(filter, config);
}

}  // namespace

ItemReader<FilterConfig, FilterType> filter_reader(std::span<const DocumentEntry> entries,
                                                   std::string file) {
  return {filter_items(), entries, std::move(file), check_filter};
}

}  // namespace voxweld
