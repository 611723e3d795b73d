// Based on: the PNG specification (W3C, third edition); only what 8-bit grey and RGB need.
#include "pipeline/report/png.h"

#include <zlib.h>

#include <array>
#include <new>
#include <span>

#include "pipeline/report/html_text.h"

namespace voxweld {
namespace {

void append_number(std::uint32_t number, std::vector<std::byte>& out) {
  for (int shift = 24; shift >= 0; shift -= 8)
    out.push_back(static_cast<std::byte>(number >> shift));
}

void append_chunk(const char* type, std::span<const std::byte> data, std::vector<std::byte>& out) {
  append_number(static_cast<std::uint32_t>(data.size()), out);
  const std::size_t begin = out.size();
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<std::byte>(type[i]));
  out.insert(out.end(), data.begin(), data.end());
  const uLong check = crc32(0, reinterpret_cast<const Bytef*>(out.data() + begin),
                            static_cast<uInt>(out.size() - begin));
  append_number(static_cast<std::uint32_t>(check), out);
}

// Each row as differences from its left (1) or its upper neighbours (2), whichever are smaller: that
// is what deflate packs well.
std::vector<std::uint8_t> filtered(const Pixels& pixels) {
  const auto row =
      static_cast<std::size_t>(pixels.width) * static_cast<std::size_t>(pixels.channels);
  const auto pixel = static_cast<std::size_t>(pixels.channels);
  std::vector<std::uint8_t> out, left(row), upper(row);
  out.reserve(pixels.data.size() + static_cast<std::size_t>(pixels.height));
  const auto cost = [](const std::vector<std::uint8_t>& differences) {
    std::uint64_t sum = 0;
    for (const std::uint8_t d : differences) sum += d < 128 ? d : 256U - d;
    return sum;
  };
  for (std::size_t y = 0; y < static_cast<std::size_t>(pixels.height); ++y) {
    const std::uint8_t* here = pixels.data.data() + y * row;
    for (std::size_t x = 0; x < row; ++x) {
      left[x] = static_cast<std::uint8_t>(here[x] - (x >= pixel ? here[x - pixel] : 0));
      upper[x] = static_cast<std::uint8_t>(here[x] - (y > 0 ? *(here + x - row) : 0));
    }
    const bool by_upper = cost(upper) < cost(left);
    out.push_back(by_upper ? 2 : 1);
    const auto& chosen = by_upper ? upper : left;
    out.insert(out.end(), chosen.begin(), chosen.end());
  }
  return out;
}

std::vector<std::byte> deflated(const std::vector<std::uint8_t>& data) {
  constexpr int level = 5;  // a twentieth larger than 9, in a third of the time
  uLongf size = compressBound(static_cast<uLong>(data.size()));
  std::vector<std::byte> out(size);
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, data.data(),
                static_cast<uLong>(data.size()), level) != Z_OK)
    throw std::bad_alloc();  // there is room for any data, so that nothing else can fail
  out.resize(size);
  return out;
}

}  // namespace

std::vector<std::byte> png_bytes(const Pixels& pixels) {
  constexpr std::array<unsigned char, 8> signature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  std::vector<std::byte> out, header;
  for (const unsigned char c : signature) out.push_back(static_cast<std::byte>(c));
  append_number(static_cast<std::uint32_t>(pixels.width), header);
  append_number(static_cast<std::uint32_t>(pixels.height), header);
  const int colour = pixels.channels == 3 ? 2 : 0;
  for (const int value : {8, colour, 0, 0, 0}) header.push_back(static_cast<std::byte>(value));
  append_chunk("IHDR", header, out);
  append_chunk("IDAT", deflated(filtered(pixels)), out);
  append_chunk("IEND", {}, out);
  return out;
}

std::string png_address(const Pixels& pixels) {
  return "data:image/png;base64," + base64(png_bytes(pixels));
}

}  // namespace voxweld
