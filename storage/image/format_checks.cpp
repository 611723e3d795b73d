#include "storage/image/format_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <span>
#include <string_view>
#include <vector>

#include "storage/support/file_io.h"

namespace voxweld {
namespace {

// libjpeg fills what is missing of a broken-off file with grey and calls that a warning. Scan data
// never holds the end marker, so a whole file has one behind its last start of scan.
bool jpeg_is_whole(const std::string& path) {
  const std::vector<std::byte> bytes = read_whole_file(path);
  const auto last = [&](int marker) {
    for (std::size_t i = bytes.size(); i >= 2; --i)
      if (bytes[i - 2] == std::byte{0xFF} && std::to_integer<int>(bytes[i - 1]) == marker) return i;
    return std::size_t{0};
  };
  return last(0xD9) > last(0xDA);
}

// The number after magic, width and height; 1 for bitmaps, 0 where it cannot be told.
int pnm_maximum(const std::string& path) {
  std::array<char, 4096> buffer{};
  const ReadFile file(path);
  const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), buffer.size()));
  file.read(0, std::as_writable_bytes(std::span(buffer)).first(size));
  const std::string_view text(buffer.data(), size);
  if (text.starts_with("P1") || text.starts_with("P4")) return 1;
  int value = 0;
  int numbers = 0;
  for (std::size_t at = 2; at < text.size() && numbers < 3;) {
    if (text[at] == '#') {
      at = std::min(text.find('\n', at), text.size());
    } else if (std::isdigit(static_cast<unsigned char>(text[at])) == 0) {
      ++at;
    } else {
      const auto end = std::from_chars(text.data() + at, text.data() + size, value).ptr;
      at = static_cast<std::size_t>(end - text.data());
      ++numbers;
    }
  }
  return numbers == 3 ? value : 0;
}

}  // namespace

std::string format_objection(const std::string& format, const std::string& path) {
  if (format == "jpeg" && !jpeg_is_whole(path))
    return "the JPEG data does not come to its end: it is truncated";
  if (format != "pnm") return {};
  const int maximum = pnm_maximum(path);
  if (maximum == 1 || maximum == 255) return {};
  // OpenImageIO multiplies these by 65535 / 65536: all but 0 lose one, and 1 becomes 0.
  if (maximum == 65535)
    return "its grey values are of 16 bits, which cannot be read exactly; expected values up to "
           "255: "
           "convert it to PNG or TIFF";
  return fmt::format(
      "its largest grey value is declared as {}; expected 255, since others are stretched to that: "
      "convert it to PNG or TIFF",
      maximum);
}

PngFacts png_facts(const std::string& path) {
  // Signature 8, chunk length 4, "IHDR" 4, width 4, height 4, then depth and colour type.
  std::array<std::byte, 26> header{};
  ReadFile(path).read(0, header);
  return {std::to_integer<int>(header[24]), std::to_integer<int>(header[25]) == 3};
}

}  // namespace voxweld
