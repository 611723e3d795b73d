// Where what is written goes.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

namespace voxweld {

// Takes the next bytes of a file.
using ByteSink = std::function<void(std::span<const std::byte>)>;

}  // namespace voxweld
