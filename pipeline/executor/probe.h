// Many small questions to the file system at once: is this artifact there, what does its header
// say. Each is answered in microseconds from a local disk and in milliseconds over a network, and
// a volume of 16384^3 has a quarter of a million of them: what takes time is the waiting, so more
// of them are under way than there are processors.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace voxweld {

inline constexpr std::size_t probes_at_once = 16;

// Calls probe(i) for each i < count, up to probes_at_once of them at a time, from threads of its
// own; returns when all are done. Results belong in places of their own by i, so that they do not
// depend on the order. Where probes throw, the exception of the lowest i comes out; those above it
// may be left out.
void probe_all(std::size_t count, const std::function<void(std::size_t)>& probe);

// The i for which holds(i), ascending.
std::vector<std::size_t> probe_which(std::size_t count,
                                     const std::function<bool(std::size_t)>& holds);

// Calls read(i) ahead, `batch` of them at a time as probe_all does, and use(i, its value) in
// ascending order on the calling thread.
template <class Value>
void probe_in_order(std::size_t count, std::size_t batch,
                    const std::function<Value(std::size_t)>& read,
                    const std::function<void(std::size_t, Value&&)>& use) {
  for (std::size_t begin = 0; begin < count; begin += batch) {
    std::vector<Value> values(std::min(batch, count - begin));
    probe_all(values.size(), [&](std::size_t i) { values[i] = read(begin + i); });
    for (std::size_t i = 0; i < values.size(); ++i) use(begin + i, std::move(values[i]));
  }
}

}  // namespace voxweld
