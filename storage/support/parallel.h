// Work inside a unit that several threads may share.
#pragma once

#include <cstddef>
#include <functional>

namespace voxweld {

// f(i) for each i < count, by the calling thread and by others of the stage at hand that have nothing
// else to do: there are some when its last units are under way. No order is kept, so what f(i) does
// must not depend on the others. What f throws is thrown here.
void for_each_index(std::size_t count, const std::function<void(std::size_t)>& f);

// Work on numbers, of which each has a result that is taken in their order.
struct OrderedWork {
  std::size_t count = 0;
  // How much i takes of what there is, from the start of its work until it is put.
  std::function<std::size_t(std::size_t i)> size;
  // As f of for_each_index(). slot: less than the slots there are, and no other i has it meanwhile.
  std::function<void(std::size_t i, std::size_t slot)> work;
  // In the order of i, one at a time, each after its work; until then the slot is its own.
  std::function<void(std::size_t i, std::size_t slot)> put;
};

// No more than `slots` numbers are at work or wait to be put, and all they take is no more than `most`,
// but where one is alone. What is thrown is thrown here.
void for_each_in_order(const OrderedWork& work, std::size_t slots, std::size_t most);

}  // namespace voxweld
