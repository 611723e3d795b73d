#include "pipeline/filter/piece_ledger.h"

#include <bit>
#include <utility>

namespace voxweld {
namespace {

// In place of a node of the next layer, where the group is complete.
constexpr std::uint32_t group_stays = ~std::uint32_t{0}, group_changes = group_stays - 1;
static_assert(PieceJoin::most_nodes <= group_changes);
constexpr std::uint64_t ledger_window = std::uint64_t{1} << 20;

template <class T>
std::vector<T> read_values(RunReader& from, std::uint64_t count) {
  std::vector<T> values(count);
  from.read(std::as_writable_bytes(std::span(values)));
  return values;
}

}  // namespace

void PieceLedger::add_block(const BlockDigest& digest) {
  blocks_.write(as_record(digest.pieces));
  blocks_.write(as_section(digest.open));
  blocks_.write(as_section(digest.changes));
  ++block_count_;
}

void PieceLedger::end_layer(const JoinedLayer& joined, const std::vector<std::uint8_t>& changes) {
  groups_.write(as_section(joined.groups));
  for (std::size_t group = 0; group < joined.next.size(); ++group) {
    std::uint32_t next = joined.next[group];
    if (next == JoinedLayer::complete) next = changes[group] != 0 ? group_changes : group_stays;
    groups_.write(as_record(next));
  }
  layers_.push_back({blocks_.end_run(), groups_.end_run(), joined.groups.size(), joined.next.size(),
                     joined.carried, std::exchange(block_count_, 0)});
}

// Of a layer: the group of each node, and of each group whether it changes.
struct PieceLedger::Verdicts {
  std::vector<std::uint32_t> groups;
  std::vector<std::uint8_t> changes;
};

// carried_on: the same of the next layer's nodes that are groups of this one.
PieceLedger::Verdicts PieceLedger::read_verdicts(const Layer& layer,
                                                 const std::vector<std::uint8_t>& carried_on,
                                                 std::optional<std::uint32_t> spared) const {
  RunReader from(groups_, layer.groups, ledger_window);
  Verdicts verdicts;
  verdicts.groups = read_values<std::uint32_t>(from, layer.nodes);
  verdicts.changes.resize(layer.group_count);
  for (std::uint8_t& changes : verdicts.changes) {
    std::uint32_t next = 0;
    from.read(std::as_writable_bytes(std::span(&next, 1)));
    changes = next == group_stays ? 0 : next == group_changes ? 1 : carried_on[next];
  }
  if (spared) verdicts.changes[*spared] = 0;
  return verdicts;
}

void PieceLedger::write_layer(std::size_t number, std::uint64_t first_block,
                              const Verdicts& verdicts, const std::optional<PiecePlace>& spared,
                              PieceChangesWriter& out) const {
  const Layer& layer = layers_[number];
  RunReader from(blocks_, layer.blocks, ledger_window);
  std::uint64_t node = layer.carried;
  for (std::uint64_t block = first_block; block < first_block + layer.block_count; ++block) {
    const auto pieces = read_values<std::uint32_t>(from, 1)[0];
    if (pieces == 0) continue;
    const auto open = read_values<std::uint64_t>(from, piece_words(pieces));
    auto changes = read_values<std::uint64_t>(from, piece_words(pieces));
    for (std::size_t word = 0; word < open.size(); ++word)
      for (std::uint64_t left = open[word]; left != 0; left &= left - 1)
        if (verdicts.changes[verdicts.groups[node++]] != 0) changes[word] |= left & (~left + 1);
    if (spared && spared->block == block)
      changes[spared->number / 64] &= ~(std::uint64_t{1} << (spared->number % 64));
    out.add(block, pieces, changes);
  }
}

void PieceLedger::write(const std::optional<PiecePlace>& spared, PieceChangesWriter& out,
                        const InterruptFlag* interrupt) const {
  std::uint64_t block = 0;
  for (const Layer& layer : layers_) block += layer.block_count;
  std::vector<std::uint8_t> carried;
  for (std::size_t number = layers_.size(); number-- > 0;) {
    if (interrupt != nullptr) interrupt->check();
    const Layer& layer = layers_[number];
    std::optional<std::uint32_t> spared_group;
    if (spared && !spared->block && spared->layer == number) spared_group = spared->number;
    const Verdicts verdicts = read_verdicts(layer, carried, spared_group);
    block -= layer.block_count;
    write_layer(number, block, verdicts, spared, out);
    carried.resize(layer.carried);
    for (std::size_t node = 0; node < carried.size(); ++node)
      carried[node] = verdicts.changes[verdicts.groups[node]];
  }
}

}  // namespace voxweld
