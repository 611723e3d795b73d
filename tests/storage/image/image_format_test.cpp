// Formats beside TIFF, where the reading library lets pass what must not pass.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <fstream>

#include "storage/image/image_file.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/support/deflated.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A grey JPEG of 8 x 8 pixels, all 100.
std::vector<std::byte> small_jpeg() {
  const std::string hex =
      "ffd8ffe000104a46494600010100000100010000ffe1001645786966000049492a00080000000000"
      "00000000ffdb0043000302020302020303030304030304050805050404050a070706080c0a0c0c0b"
      "0a0b0b0d0e12100d0e110e0b0b1016101113141515150c0f171816141812141514ffc0000b080008"
      "000801011100ffc4001f0000010501010101010100000000000000000102030405060708090a0bff"
      "c400b5100002010303020403050504040000017d0102030004110512213141061351610722711432"
      "8191a1082342b1c11552d1f02433627282090a161718191a25262728292a3435363738393a434445"
      "464748494a535455565758595a636465666768696a737475767778797a838485868788898a929394"
      "95969798999aa2a3a4a5a6a7a8a9aab2b3b4b5b6b7b8b9bac2c3c4c5c6c7c8c9cad2d3d4d5d6d7d8"
      "d9dae1e2e3e4e5e6e7e8e9eaf1f2f3f4f5f6f7f8f9faffda0008010100003f00f34affd9";
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2)
    bytes.push_back(static_cast<std::byte>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

std::string image_refusal(const std::filesystem::path& path) {
  return testing::error_text<FormatError>([&] { ImageFile file(path); });
}

std::vector<std::uint8_t> read_bytes(const std::filesystem::path& path) {
  ImageFile file(path);
  const ImagePage page = file.page(0);
  std::vector<std::uint8_t> samples(static_cast<std::size_t>(page.width * page.height));
  file.read_rows({.y0 = 0, .y1 = page.height}, std::as_writable_bytes(std::span(samples)));
  return samples;
}

TEST(Jpeg, IsRefusedWhenBrokenOff) {
  const testing::TempDirectory directory;
  const std::vector<std::byte> whole = small_jpeg();
  write_whole_file(directory / "a.jpg", whole, Durability::rename_only);
  EXPECT_EQ(read_bytes(directory / "a.jpg"), std::vector<std::uint8_t>(64, 100));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write_whole_file(directory / "a.jpg", std::span(whole).first(size), Durability::rename_only);
    EXPECT_NE(image_refusal(directory / "a.jpg"), "accepted") << size;
  }
  EXPECT_THAT(image_refusal(directory / "a.jpg"), HasSubstr("does not come to its end"));
}

TEST(Pnm, IsRefusedWhereItWouldBeStretched) {
  const testing::TempDirectory directory;
  std::ofstream(directory / "a.pgm") << "P5\n# 7 8\n3 1\n255\nABC";
  EXPECT_THAT(read_bytes(directory / "a.pgm"), ElementsAre('A', 'B', 'C'));
  std::ofstream(directory / "b.pgm") << "P5\n3 1\n100\nABC";
  EXPECT_THAT(image_refusal(directory / "b.pgm"), HasSubstr("declared as 100; expected 255"));
  std::ofstream(directory / "c.pgm") << "P5\n3 1\n65535\nABCDEF";
  EXPECT_THAT(image_refusal(directory / "c.pgm"), HasSubstr("are of 16 bits"));
}

void append_chunk(std::string& png, const std::string& type, const std::string& data) {
  const auto number = [&](unsigned long value) {
    for (int shift = 24; shift >= 0; shift -= 8) png += static_cast<char>((value >> shift) & 0xFF);
  };
  const std::string body = type + data;
  number(data.size());
  png += body;
  number(crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size())));
}

// One row of eight pixels.
void write_small_png(const std::filesystem::path& path, int bits, int colour_type,
                     const std::string& row) {
  std::string png = "\x89PNG\r\n\x1a\n";
  const std::string header = {
      0, 0, 0, 8, 0, 0, 0, 1, static_cast<char>(bits), static_cast<char>(colour_type), 0, 0, 0};
  append_chunk(png, "IHDR", header);
  if (colour_type == 3) append_chunk(png, "PLTE", "abcdef");
  const std::string filtered = std::string(1, '\0') + row;
  const auto packed = testing::deflated(as_bytes(filtered));
  append_chunk(png, "IDAT", {reinterpret_cast<const char*>(packed.data()), packed.size()});
  append_chunk(png, "IEND", "");
  std::ofstream(path) << png;
}

TEST(Png, KeepsTheValuesOfSmallDepths) {
  const testing::TempDirectory directory;
  write_small_png(directory / "1.png", 1, 0, "\xB1");
  EXPECT_THAT(read_bytes(directory / "1.png"), ElementsAre(1, 0, 1, 1, 0, 0, 0, 1));
  write_small_png(directory / "4.png", 4, 0, "\x01\x23\xEF\x80");
  EXPECT_THAT(read_bytes(directory / "4.png"), ElementsAre(0, 1, 2, 3, 14, 15, 8, 0));
  EXPECT_EQ(ImageFile(directory / "4.png").page(0).stored_bits, 4);
}

TEST(Png, TellsAPalette) {
  const testing::TempDirectory directory;
  write_small_png(directory / "p.png", 1, 3, "\xB1");
  EXPECT_TRUE(ImageFile(directory / "p.png").page(0).palette);
}

}  // namespace
}  // namespace voxweld
