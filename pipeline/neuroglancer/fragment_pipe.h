// Fragments in the order of a FragmentSort, worked on by many threads.
#pragma once

#include <tbb/parallel_pipeline.h>

#include <memory>

#include "pipeline/executor/interrupt.h"
#include "pipeline/neuroglancer/fragment_sort.h"
#include "stages/encode/fragment_codec.h"

namespace voxweld {

// Calls work(key, triangles) for each fragment on many threads, and fold(key, result) in order.
template <class Result, class Work, class Fold>
void for_each_fragment(FragmentSort& sort, int threads, const InterruptFlag* interrupt, Work work,
                       Fold fold) {
  struct In {
    FragmentSort::Key key;
    std::vector<FragmentTriangle> triangles;
  };
  struct Out {
    FragmentSort::Key key;
    Result result;
  };
  const auto next = [&](tbb::flow_control& control) -> std::shared_ptr<In> {
    if (interrupt != nullptr) interrupt->check();
    auto in = std::make_shared<In>();
    if (sort.next(in->key, in->triangles)) return in;
    control.stop();
    return nullptr;
  };
  const auto serial = tbb::filter_mode::serial_in_order;
  tbb::parallel_pipeline(
      static_cast<std::size_t>(threads),
      tbb::make_filter<void, std::shared_ptr<In>>(serial, next) &
          tbb::make_filter<std::shared_ptr<In>, std::shared_ptr<Out>>(
              tbb::filter_mode::parallel,
              [&](const std::shared_ptr<In>& in) {
                return std::make_shared<Out>(Out{in->key, work(in->key, in->triangles)});
              }) &
          tbb::make_filter<std::shared_ptr<Out>, void>(
              serial, [&](const std::shared_ptr<Out>& out) { fold(out->key, out->result); }));
}

}  // namespace voxweld
