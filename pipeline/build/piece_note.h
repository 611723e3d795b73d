// What is kept of a piece till its shard's bricks are all there: what the reduction and the directory
// need of one material in one brick.
#pragma once

#include <cstring>
#include <span>
#include <stdexcept>
#include <vector>

#include "storage/artifact/brick_pieces.h"
#include "storage/artifact/node_record_bytes.h"

namespace voxweld {

inline bool has_surface(const PieceHead& head) {
  return head.root.state != NodeState::inside;
}

struct PieceNote {
  PieceHead head;
  std::vector<FilledBlock> blocks;    // where the brick is split, those that hold anything
  std::span<const std::byte> record;  // of its NodeRecord; of memory that others own
};

inline void put_note(const PieceHead& head, std::span<const FilledBlock> blocks,
                     std::span<const std::byte> record, std::vector<std::byte>& out) {
  const auto append = [&out](const void* values, std::size_t bytes) {
    const std::size_t at = out.size();
    out.resize(at + bytes);
    if (bytes > 0) std::memcpy(out.data() + at, values, bytes);
  };
  if (head.root.state != NodeState::split) blocks = {};
  const std::uint64_t count = blocks.size();
  out.clear();
  append(&head, sizeof head);
  append(&count, sizeof count);
  append(blocks.data(), blocks.size_bytes());
  append(record.data(), record.size());
}

// Precondition: bytes of put_note, which outlive the result.
inline PieceNote note_of(std::span<const std::byte> bytes) {
  PieceNote note;
  std::uint64_t count = 0;
  std::memcpy(&note.head, bytes.data(), sizeof note.head);
  bytes = bytes.subspan(sizeof note.head);
  std::memcpy(&count, bytes.data(), sizeof count);
  bytes = bytes.subspan(sizeof count);
  note.blocks.resize(count);
  if (count > 0) std::memcpy(note.blocks.data(), bytes.data(), count * sizeof(FilledBlock));
  note.record = bytes.subspan(count * sizeof(FilledBlock));
  return note;
}

}  // namespace voxweld
