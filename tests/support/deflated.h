// Bytes compressed with zlib.
#pragma once

#include <zlib.h>

#include <cstddef>
#include <span>
#include <stdexcept>
#include <vector>

namespace voxweld::testing {

enum class Wrapper { zlib, gzip };

inline std::vector<std::byte> deflated(std::span<const std::byte> data,
                                       Wrapper wrapper = Wrapper::zlib) {
  z_stream z{};
  if (deflateInit2(&z, 6, Z_DEFLATED, wrapper == Wrapper::gzip ? 31 : 15, 8, Z_DEFAULT_STRATEGY) !=
      Z_OK)
    throw std::runtime_error("deflateInit2 failed");
  std::vector<std::byte> out(deflateBound(&z, static_cast<uLong>(data.size())) + 64);
  std::vector<std::byte> input(data.begin(), data.end());
  z.next_in = reinterpret_cast<Bytef*>(input.data());
  z.avail_in = static_cast<uInt>(input.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  const int status = deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  deflateEnd(&z);
  if (status != Z_STREAM_END) throw std::runtime_error("deflate failed");
  return out;
}

}  // namespace voxweld::testing
