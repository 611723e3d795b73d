#include "storage/volumes/mrc_header.h"

#include <algorithm>
#include <iterator>

#include "storage/support/byte_order.h"

namespace voxweld {
namespace {

constexpr std::int32_t imod_stamp = 1146047817;
constexpr std::int32_t known_modes[] = {0, 1, 2, 3, 4, 5, 6, 12, 16, 101};

class MrcFields {
 public:
  MrcFields(std::span<const std::byte> bytes, std::endian order) : bytes_(bytes), order_(order) {}

  // The words of the published tables, counted from 1.
  std::int32_t integer(std::size_t word) const {
    return load_as<std::int32_t>(bytes_.data(), 4 * (word - 1), order_);
  }
  float real(std::size_t word) const {
    return load_as<float>(bytes_.data(), 4 * (word - 1), order_);
  }
  std::array<std::int32_t, 3> integers(std::size_t word) const {
    return {integer(word), integer(word + 1), integer(word + 2)};
  }
  std::array<float, 3> reals(std::size_t word) const {
    return {real(word), real(word + 1), real(word + 2)};
  }

 private:
  std::span<const std::byte> bytes_;
  std::endian order_;
};

MrcHeader read_as(std::span<const std::byte> bytes, std::endian order) {
  const MrcFields fields(bytes, order);
  MrcHeader header;
  header.byte_order = order;
  header.size = fields.integers(1);
  header.mode = fields.integer(4);
  header.start = fields.integers(5);
  header.grid = fields.integers(8);
  header.cell = fields.reals(11);
  header.angles = fields.reals(14);
  header.axes = fields.integers(17);
  header.lowest = fields.real(20);
  header.highest = fields.real(21);
  header.space_group = fields.integer(23);
  header.extended_bytes = fields.integer(24);
  header.version = fields.integer(28);
  header.of_imod = fields.integer(39) == imod_stamp;
  header.imod_flags = fields.integer(40);
  header.origin = fields.reals(50);
  header.has_map =
      bytes[208] == std::byte{'M'} && bytes[209] == std::byte{'A'} && bytes[210] == std::byte{'P'};
  if (header.axes == std::array<std::int32_t, 3>{}) header.axes = {1, 2, 3};  // of old files
  return header;
}

bool makes_sense(const MrcHeader& header) {
  auto axes = header.axes;
  std::ranges::sort(axes);
  return std::ranges::all_of(header.size, [](auto side) { return side > 0; }) &&
         std::ranges::find(known_modes, header.mode) != std::end(known_modes) &&
         axes == std::array<std::int32_t, 3>{1, 2, 3} && header.extended_bytes >= 0;
}

}  // namespace

std::optional<MrcHeader> parse_mrc_header(std::span<const std::byte> bytes) {
  if (bytes.size() < mrc_header_bytes) return {};
  // 0x44 0x44 or 0x44 0x41: little; 0x11 0x11: big.
  const bool says_little = bytes[212] == std::byte{0x44}, says_big = bytes[212] == std::byte{0x11};
  const auto first = says_big ? std::endian::big : std::endian::little;
  const auto second = says_big ? std::endian::little : std::endian::big;
  for (const std::endian order : {first, second}) {
    MrcHeader header = read_as(bytes, order);
    header.stamped = (says_little || says_big) && order == first;
    if (makes_sense(header)) return header;
  }
  return {};
}

}  // namespace voxweld
