// A filter of the config that is to be put around a source.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <memory>
#include <string>

#include "pipeline/config/config.h"
#include "storage/support/error.h"
#include "storage/types/volume.h"

namespace voxweld {

struct FilterRequest {
  const FilterConfig& filter;  // not keep or fill (pieces.h)
  std::size_t number = 1;      // of it in the config, from 1: for messages
  // What the filter's path holds, of Access::box; of a mask.
  std::shared_ptr<SampleSource> mask{};
};

[[noreturn]] inline void refuse_filter(const FilterRequest& request, const std::string& problem) {
  throw InputError(fmt::format("filter {}: {}", request.number, problem));
}

}  // namespace voxweld
