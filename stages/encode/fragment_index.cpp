#include "stages/encode/fragment_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "storage/support/error.h"

namespace voxweld {
namespace {

void add_missing(std::vector<FragmentEntry>& fragments, std::vector<std::uint64_t> codes) {
  std::ranges::sort(codes);
  codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  const std::size_t listed = fragments.size();
  for (const std::uint64_t code : codes)
    if (!std::binary_search(
            fragments.begin(), fragments.begin() + static_cast<std::ptrdiff_t>(listed),
            FragmentEntry{code, 0, 0},
            [](const FragmentEntry& a, const FragmentEntry& b) { return a.code < b.code; }))
      fragments.push_back({code, 0, 0});
  std::ranges::sort(fragments, {}, &FragmentEntry::code);
}

// All numbers are written in the machine's order, which is little-endian.
template <class T>
void put_number(std::vector<std::byte>& out, T value) {
  const std::size_t at = out.size();
  out.resize(at + sizeof value);
  std::memcpy(out.data() + at, &value, sizeof value);
}

class IndexReader {
 public:
  IndexReader(std::span<const std::byte> bytes, const std::string& where)
      : bytes_(bytes), where_(where) {}

  template <class T>
  T take() {
    if (bytes_.size() < sizeof(T))
      throw FormatError(where_ + ": is no list of fragments: it ends too early");
    T value;
    std::memcpy(&value, bytes_.data(), sizeof(T));
    bytes_ = bytes_.subspan(sizeof(T));
    return value;
  }
  std::size_t left() const { return bytes_.size(); }

 private:
  std::span<const std::byte> bytes_;
  const std::string& where_;
};

void read_fragments(IndexReader& in, FragmentLevel& level) {
  std::vector<FragmentCell> cells(level.fragments.size());
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (FragmentCell& cell : cells) cell[axis] = in.take<std::uint32_t>();
  for (std::size_t i = 0; i < cells.size(); ++i)
    level.fragments[i] = {fragment_code(cells[i]), in.take<std::uint32_t>(), 0};
}

}  // namespace

void add_empty_fragments(std::vector<FragmentLevel>& levels) {
  for (std::size_t k = levels.size(); k-- > 1;) {
    std::vector<std::uint64_t> below;
    for (const FragmentEntry& fragment : levels[k].fragments)
      for (unsigned octant = 0; octant < 8; ++octant)
        if ((fragment.octants >> octant & 1) != 0) below.push_back(fragment.code << 3 | octant);
    add_missing(levels[k - 1].fragments, std::move(below));
  }
  for (std::size_t k = 1; k < levels.size(); ++k) {
    std::vector<std::uint64_t> above;
    for (const FragmentEntry& fragment : levels[k - 1].fragments)
      above.push_back(fragment.code >> 3);
    add_missing(levels[k].fragments, std::move(above));
  }
}

std::vector<std::byte> index_bytes(const FragmentIndex& index) {
  std::vector<std::byte> out;
  for (const float side : index.chunk_shape) put_number(out, side);
  for (const float at : index.grid_origin) put_number(out, at);
  put_number(out, static_cast<std::uint32_t>(index.levels.size()));
  for (const FragmentLevel& level : index.levels) put_number(out, level.scale);
  for (std::size_t i = 0; i < 3 * index.levels.size(); ++i) put_number(out, 0.0F);
  for (const FragmentLevel& level : index.levels)
    put_number(out, static_cast<std::uint32_t>(level.fragments.size()));
  for (const FragmentLevel& level : index.levels) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const FragmentEntry& fragment : level.fragments)
        put_number(out, fragment_cell(fragment.code)[axis]);
    for (const FragmentEntry& fragment : level.fragments) put_number(out, fragment.bytes);
  }
  return out;
}

FragmentIndex read_index(std::span<const std::byte> bytes, const std::string& where) {
  IndexReader in(bytes, where);
  FragmentIndex index;
  for (float& side : index.chunk_shape) side = in.take<float>();
  for (float& at : index.grid_origin) at = in.take<float>();
  const auto levels = in.take<std::uint32_t>();
  if (levels > in.left() / 20)
    throw FormatError(
        fmt::format("{}: states {} levels of detail, more than it has room for", where, levels));
  index.levels.resize(levels);
  for (FragmentLevel& level : index.levels) level.scale = in.take<float>();
  for (std::size_t i = 0; i < 3 * index.levels.size(); ++i)
    if (in.take<float>() != 0)
      throw FormatError(where + ": has vertex offsets, which voxweld never writes");
  std::uint64_t fragments = 0;
  std::vector<std::uint32_t> counts(levels);
  for (std::uint32_t& count : counts) fragments += count = in.take<std::uint32_t>();
  if (in.left() != 16 * fragments)
    throw FormatError(fmt::format("{}: lists {} fragments in {} bytes, expected {}", where,
                                  fragments, in.left(), 16 * fragments));
  for (std::size_t k = 0; k < levels; ++k) {
    index.levels[k].fragments.resize(counts[k]);
    read_fragments(in, index.levels[k]);
  }
  return index;
}

}  // namespace voxweld
