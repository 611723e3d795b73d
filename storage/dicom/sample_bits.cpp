#include "storage/dicom/sample_bits.h"

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "storage/support/byte_order.h"

namespace voxweld {
namespace {

// Left to the top, so that what lies above is gone; then right, by the signed type with the sign.
template <class T>
void shift_bits(std::byte* data, std::size_t count, const SampleBits& bits) {
  const int up = bits.allocated - 1 - bits.high, down = bits.allocated - bits.stored;
  for (std::size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, data + i * sizeof(T), sizeof(T));
    const auto raised = static_cast<T>(static_cast<std::make_unsigned_t<T>>(value) << up);
    value = static_cast<T>(raised >> down);
    std::memcpy(data + i * sizeof(T), &value, sizeof(T));
  }
}

}  // namespace

void settle_bits(std::byte* data, std::size_t count, const SampleBits& bits, std::endian order) {
  to_native(data, count, static_cast<std::size_t>(bits.allocated / 8), order);
  if (bits.stored == bits.allocated) return;
  switch (image_sample_type(bits)) {
    case SampleType::u8:
      return shift_bits<std::uint8_t>(data, count, bits);
    case SampleType::i8:
      return shift_bits<std::int8_t>(data, count, bits);
    case SampleType::u16:
      return shift_bits<std::uint16_t>(data, count, bits);
    case SampleType::i16:
      return shift_bits<std::int16_t>(data, count, bits);
    case SampleType::u32:
      return shift_bits<std::uint32_t>(data, count, bits);
    default:
      return shift_bits<std::int32_t>(data, count, bits);
  }
}

}  // namespace voxweld
