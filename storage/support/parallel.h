// Work inside a unit that several threads may share.
#pragma once

#include <cstddef>
#include <functional>

namespace voxweld {

// f(i) for each i < count, by the calling thread and by others of the stage at hand that have nothing
// else to do: there are some when its last units are under way. No order is kept, so what f(i) does
// must not depend on the others. What f throws is thrown here.
void for_each_index(std::size_t count, const std::function<void(std::size_t)>& f);

}  // namespace voxweld
