// The tiles that a list names, on many threads, in the list's order.
#pragma once

#include <tbb/parallel_pipeline.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "storage/manifest/manifest.h"

namespace voxweld {

// Calls work(record, its place in the list) for each listed tile for which takes(record) holds, on many
// threads, and then fold for each result, in the list's order.
template <class Result, class Takes, class Work, class Fold>
void for_each_taken(const std::filesystem::path& list, int threads, Takes takes, Work work,
                    Fold fold) {
  TileListReader reader(list);
  std::size_t number = 0;
  using Numbered = std::pair<TileRecord, std::size_t>;
  const auto next = [&](tbb::flow_control& control) {
    std::optional<TileRecord> record = reader.next();
    for (; record && !takes(*record); record = reader.next()) ++number;
    if (!record) control.stop();
    return record ? std::make_shared<Numbered>(std::move(*record), number++) : nullptr;
  };
  using In = std::shared_ptr<Numbered>;
  using Out = std::shared_ptr<Result>;
  const auto serial = tbb::filter_mode::serial_in_order;
  tbb::parallel_pipeline(
      static_cast<std::size_t>(threads),
      tbb::make_filter<void, In>(serial, next) &
          tbb::make_filter<In, Out>(tbb::filter_mode::parallel,
                                    [&](const In& in) {
                                      return std::make_shared<Result>(
                                          work(std::move(in->first), in->second));
                                    }) &
          tbb::make_filter<Out, void>(serial, [&](const Out& result) { fold(*result); }));
}

// The same for each of them.
template <class Result, class Work, class Fold>
void for_each_tile(const std::filesystem::path& list, int threads, Work work, Fold fold) {
  for_each_taken<Result>(
      list, threads, [](const TileRecord&) { return true; }, std::move(work), std::move(fold));
}

}  // namespace voxweld
