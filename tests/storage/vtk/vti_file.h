// VTI files as a test wants them, in all that the format allows.
#pragma once

#include <fmt/format.h>
#include <lz4.h>
#include <lzma.h>

#include <string>
#include <vector>

#include "tests/storage/volumes/known_volume.h"

namespace voxweld::testing {

struct VtiForm {
  std::string format = "appended";  // or "ascii", "binary"
  bool base64 = false;              // of appended data; "binary" is base64 always
  std::string codec = "";           // "ZLib", "LZ4", "LZMA"; empty: none
  std::size_t word_bytes = 4;       // header_type
  std::endian order = std::endian::little;
  std::size_t block = 32768;
};

inline std::string to_text(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline std::string base64_of(const Bytes& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t j = 0; j < 3; ++j)
      bits = bits << 8 | (i + j < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + j]) : 0U);
    for (std::size_t j = 0; j < 4; ++j)
      text += j > bytes.size() - i ? '=' : digits[bits >> (18 - 6 * j) & 63U];
  }
  return text;
}

inline Bytes words_of(const std::vector<std::uint64_t>& values, const VtiForm& form) {
  Bytes bytes;
  for (const std::uint64_t value : values)
    for (std::size_t i = 0; i < form.word_bytes; ++i) {
      const std::size_t place = form.order == std::endian::little ? i : form.word_bytes - 1 - i;
      bytes.push_back(static_cast<std::byte>(value >> (8 * place) & 255U));
    }
  return bytes;
}

inline Bytes packed_block(const Bytes& block, const std::string& codec) {
  if (codec == "ZLib") return deflated(block);
  Bytes out(block.size() * 2 + 1000);
  if (codec == "LZ4") {
    const int size = LZ4_compress_default(
        reinterpret_cast<const char*>(block.data()), reinterpret_cast<char*>(out.data()),
        static_cast<int>(block.size()), static_cast<int>(out.size()));
    out.resize(static_cast<std::size_t>(size));
    return out;
  }
  std::size_t size = 0;
  if (lzma_easy_buffer_encode(
          5, LZMA_CHECK_CRC32, nullptr, reinterpret_cast<const std::uint8_t*>(block.data()),
          block.size(), reinterpret_cast<std::uint8_t*>(out.data()), &size, out.size()) != LZMA_OK)
    throw std::runtime_error("lzma_easy_buffer_encode failed");
  out.resize(size);
  return out;
}

// As they stand in the file: lengths, then samples, all or none in base64.
inline std::string stored_array(const Bytes& samples, const VtiForm& form) {
  const bool base64 = form.format == "binary" || form.base64;
  const auto encoded = [&](const Bytes& bytes) {
    return base64 ? base64_of(bytes) : to_text(bytes);
  };
  if (form.codec.empty()) return encoded(words_of({samples.size()}, form) + samples);
  std::vector<std::uint64_t> words = {0, form.block, samples.size() % form.block};
  Bytes blocks;
  for (std::size_t at = 0; at < samples.size(); at += form.block) {
    const auto begin = samples.begin() + static_cast<std::ptrdiff_t>(at);
    const auto end =
        samples.begin() + static_cast<std::ptrdiff_t>(std::min(samples.size(), at + form.block));
    const Bytes block = packed_block(Bytes(begin, end), form.codec);
    words.push_back(block.size());
    blocks = blocks + block;
    ++words[0];
  }
  return encoded(words_of(words, form)) + encoded(blocks);
}

inline std::string vti_type(SampleType type) {
  const std::string_view name = sample_type_name(type);
  const std::string kind = name.starts_with("u") ? "UInt" : name.starts_with("i") ? "Int" : "Float";
  return fmt::format("{}{}", kind, 8 * sample_bytes(type));
}

struct VtiNamedArray {
  std::string name;
  KnownVolume volume;
  bool of_cells = false;
  std::string attributes = "";  // more of them
};

// A file of these arrays. lattice: attributes of ImageData; scalars: of PointData.
inline std::string vti_file(const std::vector<VtiNamedArray>& arrays, const VtiForm& form,
                            const std::string& lattice, const std::string& extent,
                            const std::string& scalars = "") {
  std::string appended;
  const auto element = [&](const VtiNamedArray& array) {
    std::string text =
        fmt::format("<DataArray type=\"{}\" Name=\"{}\" format=\"{}\" {}",
                    vti_type(array.volume.type), array.name, form.format, array.attributes);
    const std::string data = form.format == "ascii"
                                 ? as_text(array.volume)
                                 : stored_array(array.volume.stored(form.order), form);
    if (form.format != "appended") return text + ">\n  " + data + "\n</DataArray>\n";
    text += fmt::format(" offset=\"{}\"/>\n", appended.size());
    appended += data;
    return text;
  };
  std::string points, cells;
  for (const VtiNamedArray& array : arrays) (array.of_cells ? cells : points) += element(array);
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<!-- a > b -->\n<VTKFile type=\"ImageData\" version=\"1.0\" "
      "byte_order=\"{}\" "
      "header_type=\"UInt{}\"{}>\n<ImageData WholeExtent=\"{}\" {}>\n<Piece Extent=\"{}\">\n"
      "<PointData {}>\n{}</PointData>\n<CellData>\n{}</CellData>\n</Piece>\n</ImageData>\n",
      form.order == std::endian::little ? "LittleEndian" : "BigEndian", 8 * form.word_bytes,
      form.codec.empty() ? "" : fmt::format(" compressor=\"vtk{}DataCompressor\"", form.codec),
      extent, lattice, extent, scalars, points, cells);
  if (form.format == "appended")
    text += fmt::format("<AppendedData encoding=\"{}\">\n   _{}\n  </AppendedData>\n",
                        form.base64 ? "base64" : "raw", appended);
  return text + "</VTKFile>\n";
}

inline std::string extent_of(Index3 size) {
  return fmt::format("0 {} 0 {} 0 {}", size.x - 1, size.y - 1, size.z - 1);
}

inline std::string vti_file(const KnownVolume& volume, const VtiForm& form) {
  return vti_file({{"v", volume}}, form, "Origin=\"1 2 3\" Spacing=\"1 2 0.5\"",
                  extent_of(volume.size));
}

}  // namespace voxweld::testing
