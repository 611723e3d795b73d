#include "stages/refine/known_hits.h"

#include <algorithm>

namespace voxweld {

void KnownHits::add(std::uint32_t t, std::uint32_t other) {
  std::uint32_t n = free_;
  if (n == end) {
    n = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
  } else {
    free_ = nodes_[n].next;
  }
  nodes_[n] = {other, heads_[t]};
  heads_[t] = n;
}

void KnownHits::remove(std::uint32_t t, std::uint32_t other) {
  for (std::uint32_t* at = &heads_[t]; *at != end; at = &nodes_[*at].next) {
    const std::uint32_t n = *at;
    if (nodes_[n].triangle != other) continue;
    *at = nodes_[n].next;
    nodes_[n].next = free_;
    free_ = n;
    return;
  }
}

bool KnownHits::holds(std::uint32_t t, std::uint32_t other) const {
  for (std::uint32_t n = heads_[t]; n != end; n = nodes_[n].next)
    if (nodes_[n].triangle == other) return true;
  return false;
}

void KnownHits::forget(std::uint32_t t) {
  while (heads_[t] != end) {
    const std::uint32_t n = heads_[t];
    heads_[t] = nodes_[n].next;
    nodes_[n].next = free_;
    free_ = n;
  }
  heads_[t] = unknown;
}

void KnownHits::look_up(std::uint32_t t) {
  heads_[t] = end;
  // Of pairs of which the other one was looked up it is known.
  mesh_.each_hit_if(
      t,
      [&](std::uint32_t other) {
        return heads_[other] == unknown ? mesh_.hit(t, other) : holds(other, t);
      },
      [&](std::uint32_t other) { add(t, other); });
}

std::size_t KnownHits::pairs_of(std::span<const std::uint32_t> some,
                                std::vector<std::uint32_t>& others) {
  std::size_t ends = 0, within = 0;  // of pairs; a pair within `some` has two there
  others.clear();
  for (const std::uint32_t t : some)
    each(t, [&](std::uint32_t other) {
      ++ends;
      if (std::ranges::find(some, other) != some.end())
        ++within;
      else
        others.push_back(other);
    });
  std::sort(others.begin(), others.end());
  others.erase(std::unique(others.begin(), others.end()), others.end());
  return ends - within / 2;
}

void KnownHits::before(const Change& change) {
  // All of them first: what is looked up has to find the others as they are.
  for (const std::uint32_t t : change.old)
    if (heads_[t] == unknown) look_up(t);
  for (const std::uint32_t t : change.old)
    for (std::uint32_t n = heads_[t]; n != end; n = nodes_[n].next)
      if (heads_[nodes_[n].triangle] != unknown && nodes_[n].triangle != t)
        remove(nodes_[n].triangle, t);
  for (const std::uint32_t t : change.old) forget(t);
}

void KnownHits::after(const Change& change) {
  const std::span<const std::uint32_t> made(change.old.data(), change.now.size());
  for (const std::uint32_t t : made) {
    heads_[t] = end;
    mesh_.each_hit(t, [&](std::uint32_t other) { add(t, other); });
    for (std::uint32_t n = heads_[t]; n != end; n = nodes_[n].next) {
      const std::uint32_t other = nodes_[n].triangle;
      const bool is_new = std::ranges::find(made, other) != made.end();
      if (!is_new && heads_[other] != unknown) add(other, t);
    }
  }
}

}  // namespace voxweld
