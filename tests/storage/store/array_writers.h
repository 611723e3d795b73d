// Zip files, blocks of N5 and shards, made byte by byte.
#pragma once

#include <lz4.h>
#include <xxhash.h>
#include <zlib.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "storage/store/crc32c.h"
#include "tests/support/deflated.h"

namespace voxweld::testing {

// The low `width` bytes of the value.
inline std::string number_bytes(std::uint64_t value, std::size_t width,
                                std::endian order = std::endian::little) {
  std::string bytes;
  for (std::size_t i = 0; i < width; ++i) {
    const std::size_t byte = order == std::endian::little ? i : width - 1 - i;
    bytes += static_cast<char>(value >> 8 * byte & 0xff);
  }
  return bytes;
}

struct ZipForm {
  bool deflate = false, zip64 = false;
  std::string comment{};
};

// A zip file of these members, in this order.
inline std::string zip_of(const std::vector<std::pair<std::string, std::string>>& members,
                          const ZipForm& form = {}) {
  std::string file, list;
  for (const auto& [name, bytes] : members) {
    std::string data = bytes;
    if (form.deflate) {  // a zlib stream without its header of 2 bytes and checksum of 4
      const auto packed = deflated(std::as_bytes(std::span(bytes)), Wrapper::zlib);
      data.assign(reinterpret_cast<const char*>(packed.data()) + 2, packed.size() - 6);
    }
    const auto crc =
        crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()));
    const std::string same = number_bytes(45, 2) + number_bytes(0, 2) +
                             number_bytes(form.deflate ? 8 : 0, 2) + number_bytes(0, 4) +
                             number_bytes(crc, 4);
    const std::uint64_t all = 0xffffffff, offset = file.size();
    const std::string sizes = number_bytes(form.zip64 ? all : data.size(), 4) +
                              number_bytes(form.zip64 ? all : bytes.size(), 4);
    const std::string wide = number_bytes(bytes.size(), 8) + number_bytes(data.size(), 8);
    const std::string extra =
        form.zip64 ? number_bytes(1, 2) + number_bytes(24, 2) + wide + number_bytes(offset, 8) : "";
    const std::string local = form.zip64 ? number_bytes(1, 2) + number_bytes(16, 2) + wide : "";
    for (const std::string& part :
         {std::string("PK\3\4"), same, sizes, number_bytes(name.size(), 2),
          number_bytes(local.size(), 2), name, local, data})
      file += part;
    for (const std::string& part :
         {std::string("PK\1\2"), number_bytes(45, 2), same, sizes, number_bytes(name.size(), 2),
          number_bytes(extra.size(), 2), number_bytes(0, 8), number_bytes(0, 2),
          number_bytes(form.zip64 ? all : offset, 4), name, extra})
      list += part;
  }
  const std::uint64_t begin = file.size(), count = members.size();
  file += list;
  if (form.zip64) {
    const std::uint64_t record = file.size();
    file += "PK\6\6" + number_bytes(44, 8) + number_bytes(45, 2) + number_bytes(45, 2) +
            number_bytes(0, 8) + number_bytes(count, 8) + number_bytes(count, 8) +
            number_bytes(list.size(), 8) + number_bytes(begin, 8);
    file += "PK\6\7" + number_bytes(0, 4) + number_bytes(record, 8) + number_bytes(1, 4);
  }
  const std::uint64_t none = form.zip64 ? 0xffffffff : 0;
  return file + "PK\5\6" + number_bytes(0, 4) + number_bytes(form.zip64 ? 0xffff : count, 2) +
         number_bytes(form.zip64 ? 0xffff : count, 2) + number_bytes(none | list.size(), 4) +
         number_bytes(none | begin, 4) + number_bytes(form.comment.size(), 2) + form.comment;
}

// The stream that lz4-java writes, in blocks of so many bytes.
inline std::string lz4_blocks(const std::string& bytes, std::size_t block = 64) {
  std::string out;
  const auto header = [&](unsigned token, std::size_t packed, std::size_t size,
                          std::uint32_t checksum) {
    out += "LZ4Block" + number_bytes(token, 1) + number_bytes(packed, 4) + number_bytes(size, 4) +
           number_bytes(checksum, 4);
  };
  for (std::size_t at = 0; at < bytes.size(); at += block) {
    const std::string part = bytes.substr(at, block);
    std::string packed(static_cast<std::size_t>(LZ4_compressBound(static_cast<int>(block))), '\0');
    packed.resize(static_cast<std::size_t>(LZ4_compress_default(part.data(), packed.data(),
                                                                static_cast<int>(part.size()),
                                                                static_cast<int>(packed.size()))));
    const bool raw = packed.size() >= part.size();
    header(raw ? 0x10 : 0x20, raw ? part.size() : packed.size(), part.size(),
           XXH32(part.data(), part.size(), 0x9747b28c) & 0x0fffffff);
    out += raw ? part : packed;
  }
  header(0x10, 0, 0, 0);
  return out;
}

// Sizes: the fastest dimension first.
inline std::string n5_header(const std::vector<std::uint64_t>& sizes, unsigned mode = 0) {
  std::string out =
      number_bytes(mode, 2, std::endian::big) + number_bytes(sizes.size(), 2, std::endian::big);
  for (const std::uint64_t size : sizes) out += number_bytes(size, 4, std::endian::big);
  return out;
}

// A shard of these pieces, in the order of its index; "" where one is missing.
inline std::string shard_of(const std::vector<std::string>& pieces, bool index_at_end = true) {
  std::string data, index;
  const std::uint64_t start = index_at_end ? 0 : 16 * pieces.size() + 4;
  for (const std::string& piece : pieces) {
    const std::uint64_t none = piece.empty() ? ~std::uint64_t{0} : 0;
    index += number_bytes(none | (start + data.size()), 8) + number_bytes(none | piece.size(), 8);
    data += piece;
  }
  index += number_bytes(crc32c(std::as_bytes(std::span(index))), 4);
  return index_at_end ? data + index : index + data;
}

}  // namespace voxweld::testing
