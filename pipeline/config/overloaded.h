// One visitor made of a lambda for each alternative of a variant.
#pragma once

namespace voxweld {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
// Older compilers do not deduce this by themselves.
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace voxweld
