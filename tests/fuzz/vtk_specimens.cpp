#include "tests/fuzz/vtk_specimens.h"

#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <utility>

#include "tests/support/deflated.h"

namespace voxweld::testing {
namespace {

std::string base64_text(const std::string& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t j = 0; j < 3; ++j)
      bits = bits << 8 | (i + j < bytes.size() ? static_cast<std::uint8_t>(bytes[i + j]) : 0U);
    for (std::size_t j = 0; j < 4; ++j)
      text += j > bytes.size() - i ? '=' : digits[bits >> (18 - 6 * j) & 63U];
  }
  return text;
}

std::string word(std::size_t value) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 255U);
  return bytes;
}

std::string vti(Index3 size, const std::string& root, const std::string& array,
                const std::string& appended) {
  const std::string extent = fmt::format("0 {} 0 {} 0 {}", size.x - 1, size.y - 1, size.z - 1);
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt32\" {}>\n<ImageData WholeExtent=\"{}\" "
      "Origin=\"1 2 3\" Spacing=\"1 2 0.5\" Direction=\"1 0 0 0 1 0 0 0 1\">\n<Piece "
      "Extent=\"{}\">\n<PointData Scalars=\"v\">\n<DataArray type=\"Int16\" Name=\"v\" "
      "{}</DataArray>\n</PointData>\n</Piece>\n</ImageData>\n{}</VTKFile>\n",
      root, extent, extent, array, appended);
}

// In blocks, as vtkZLibDataCompressor has them.
std::string zlib_blocks(const std::string& raw) {
  constexpr std::size_t block = 4096;
  std::string sizes, data;
  std::size_t count = 0;
  for (std::size_t at = 0; at < raw.size(); at += block, ++count) {
    const std::string part = raw.substr(at, block);
    const auto packed = deflated(std::as_bytes(std::span(part)));
    sizes += word(packed.size());
    data.append(reinterpret_cast<const char*>(packed.data()), packed.size());
  }
  return word(count) + word(block) + word(raw.size() % block) + sizes + data;
}

std::string legacy(Index3 size, const std::string& form, const std::string& values) {
  return fmt::format(
      "# vtk DataFile Version 3.0\na ball\n{}\nDATASET STRUCTURED_POINTS\nDIMENSIONS {} {} {}\n"
      "SPACING 1 2 0.5\nORIGIN 1 2 3\nPOINT_DATA {}\nSCALARS v short\nLOOKUP_TABLE default\n{}\n",
      form, size.x, size.y, size.z, size.x * size.y * size.z, values);
}

}  // namespace

std::vector<SmallFile> vtk_files(Index3 size, const std::string& raw, const std::string& text) {
  const std::string appended = "format=\"appended\" offset=\"0\">";
  const auto block = [](const std::string& data) {
    return "<AppendedData encoding=\"raw\">\n_" + data + "\n</AppendedData>\n";
  };
  std::string big = raw;
  for (std::size_t i = 0; i + 1 < big.size(); i += 2) std::swap(big[i], big[i + 1]);
  return {{"vti", "v.vti", vti(size, "", appended, block(word(raw.size()) + raw))},
          {"vti-zlib", "v.vti",
           vti(size, "compressor=\"vtkZLibDataCompressor\"", appended, block(zlib_blocks(raw)))},
          {"vti-base64", "v.vti",
           vti(size, "", "format=\"binary\">" + base64_text(word(raw.size()) + raw), "")},
          {"vti-ascii", "v.vti", vti(size, "", "format=\"ascii\">" + text, "")},
          {"vtk", "v.vtk", legacy(size, "BINARY", big)},
          {"vtk-ascii", "v.vtk", legacy(size, "ASCII", text)}};
}

}  // namespace voxweld::testing
