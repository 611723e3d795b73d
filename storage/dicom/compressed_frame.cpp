// Based on: NEMA, DICOM PS3.5 (2023), annex G (run lengths); ITU-T T.81, T.87 (markers of JPEG and
// JPEG-LS); ITU-T T.800, annex A (markers of JPEG 2000).
#include "storage/dicom/compressed_frame.h"

#include <fmt/format.h>
#include <gdcmByteValue.h>
#include <gdcmDataElement.h>
#include <gdcmFragment.h>
#include <gdcmJPEG2000Codec.h>
#include <gdcmJPEGCodec.h>
#include <gdcmJPEGLSCodec.h>
#include <gdcmSequenceOfFragments.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "storage/dicom/work_apart.h"
#include "storage/support/byte_order.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

using Stored = std::span<const std::byte>;

unsigned byte_at(Stored data, std::size_t at) {
  return std::to_integer<unsigned>(data[at]);
}
std::uint32_t big16(Stored data, std::size_t at) {
  return load_as<std::uint16_t>(data.data(), at, std::endian::big);
}
std::uint32_t big32(Stored data, std::size_t at) {
  return load_as<std::uint32_t>(data.data(), at, std::endian::big);
}

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw FormatError(where + ": " + what);
}

// Run lengths ------------------------------------------------------------------------------------

// One plane of bytes, `step` apart in out. False where the runs do not make exactly so many.
bool unpack_runs(Stored runs, std::span<std::byte> out, std::size_t step) {
  std::size_t at = 0, to = 0;
  while (to < out.size()) {
    if (at >= runs.size()) return false;
    const auto control = static_cast<std::int8_t>(byte_at(runs, at++));
    if (control == -128) continue;
    const std::size_t count = control >= 0 ? static_cast<std::size_t>(control) + 1
                                           : static_cast<std::size_t>(1 - control);
    const std::size_t taken = control >= 0 ? count : 1;
    if (taken > runs.size() - at) return false;
    // A run may reach beyond the end by what filled the plane to an even number of bytes.
    for (std::size_t i = 0; i < count && to < out.size(); ++i, to += step)
      out[to] = runs[at + (control >= 0 ? i : 0)];
    at += taken;
  }
  return true;
}

void decode_runs(const DicomImage& image, const std::string& where, Stored stored,
                 std::span<std::byte> out) {
  constexpr std::size_t header_bytes = 64;
  const auto planes = static_cast<std::size_t>(image.bits.allocated / 8);
  if (stored.size() < header_bytes) fail(where, "its run lengths are cut short");
  const auto word = [&](std::size_t i) {
    return std::size_t{load_as<std::uint32_t>(stored.data(), 4 * i, std::endian::little)};
  };
  if (word(0) != planes)
    fail(where, fmt::format("its run lengths are in {} segments, but samples of {} bits take {}",
                            word(0), image.bits.allocated, planes));
  for (std::size_t p = 0; p < planes; ++p) {
    const std::size_t begin = word(1 + p), end = p + 1 < planes ? word(2 + p) : stored.size();
    // The first plane holds the highest byte of each sample.
    const std::size_t first = std::endian::native == std::endian::little ? planes - 1 - p : p;
    if (begin < header_bytes || begin > end || end > stored.size() ||
        !unpack_runs(stored.subspan(begin, end - begin), out.subspan(first), planes))
      fail(where, fmt::format("segment {} of its run lengths is damaged", p + 1));
  }
}

// JPEG and its kin -------------------------------------------------------------------------------

struct StreamFacts {
  std::uint64_t width = 0, height = 0, components = 0, bits = 0;
  std::uint64_t tiles = 1;
};

// From the frame header of a JPEG or JPEG-LS stream. False where there is none.
bool jpeg_facts(Stored data, StreamFacts& facts) {
  if (data.size() < 4 || big16(data, 0) != 0xffd8) return false;
  std::size_t at = 2;
  while (at + 4 <= data.size()) {
    if (byte_at(data, at) != 0xff) return false;
    const unsigned marker = byte_at(data, at + 1);
    if (marker == 0xff) {  // filling
      ++at;
      continue;
    }
    const bool frame =
        (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) ||
        marker == 0xf7;
    if (frame && at + 10 <= data.size()) {
      facts = {big16(data, at + 7), big16(data, at + 5), byte_at(data, at + 9),
               byte_at(data, at + 4)};
      return true;
    }
    if (frame || marker == 0xda) return false;
    at += 2 + big16(data, at + 2);
  }
  return false;
}

// From the first marker of a JPEG 2000 stream, which may lie in the boxes of a JP2 file.
bool jpeg_2000_facts(Stored data, StreamFacts& facts) {
  constexpr std::array start{std::byte{0xff}, std::byte{0x4f}, std::byte{0xff}, std::byte{0x51}};
  constexpr std::size_t searched = 4096, header = 47;
  const Stored front = data.first(std::min(searched, data.size()));
  const auto found = std::search(front.begin(), front.end(), start.begin(), start.end());
  if (found == front.end()) return false;
  const auto at = static_cast<std::size_t>(found - front.begin());
  if (data.size() - at < header) return false;
  const Stored siz = data.subspan(at);
  const std::uint64_t x1 = big32(siz, 8), y1 = big32(siz, 12), x0 = big32(siz, 16),
                      y0 = big32(siz, 20), tile_x = big32(siz, 24), tile_y = big32(siz, 28);
  if (x0 >= x1 || y0 >= y1 || tile_x == 0 || tile_y == 0) return false;
  facts = {x1 - x0, y1 - y0, big16(siz, 40), (byte_at(siz, 42) & 0x7fU) + 1,
           ((x1 - 1) / tile_x + 1) * ((y1 - 1) / tile_y + 1)};
  return true;
}

void check_stream(const DicomImage& image, const std::string& where, Stored stored) {
  StreamFacts facts;
  const bool is_2000 = image.syntax.coding == FrameCoding::jpeg_2000;
  if (!(is_2000 ? jpeg_2000_facts(stored, facts) : jpeg_facts(stored, facts)))
    fail(where, fmt::format("its samples are no stream of {}", image.syntax.name));
  const auto columns = static_cast<std::uint64_t>(image.columns),
             rows = static_cast<std::uint64_t>(image.rows);
  const std::uint64_t taken = facts.bits <= 8 ? 8 : facts.bits <= 16 ? 16 : 32;
  if (facts.width != columns || facts.height != rows || facts.components != 1 ||
      taken != static_cast<std::uint64_t>(image.bits.allocated))
    fail(where,
         fmt::format("its compressed image is {} x {}, {} component{} of {} bits, but the "
                     "header says {} x {} of {} bits allocated",
                     facts.width, facts.height, facts.components, facts.components == 1 ? "" : "s",
                     facts.bits, columns, rows, image.bits.allocated));
  // Each tile takes the markers of a tile part at least; decoders allocate for it.
  if (facts.tiles > stored.size() / 12)
    fail(where, fmt::format("its compressed image is in {} tiles, for which it is too short",
                            facts.tiles));
}

template <class Codec>
bool decode_by(const DicomImage& image, const gdcm::DataElement& in, gdcm::DataElement& out) {
  Codec codec;
  const auto bits = [](int n) { return static_cast<unsigned short>(n); };
  const unsigned int dimensions[3] = {static_cast<unsigned>(image.columns),
                                      static_cast<unsigned>(image.rows), 1};
  codec.SetNumberOfDimensions(2);
  codec.SetDimensions(dimensions);
  codec.SetPlanarConfiguration(0);
  codec.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  codec.SetPixelFormat(gdcm::PixelFormat(1, bits(image.bits.allocated), bits(image.bits.stored),
                                         bits(image.bits.stored - 1),
                                         bits(image.bits.is_signed ? 1 : 0)));
  return codec.Decode(in, out);
}

bool decode_by_gdcm(const DicomImage& image, Stored stored, std::span<std::byte> out) {
  const auto fragments = gdcm::SequenceOfFragments::New();
  gdcm::Fragment fragment;
  fragment.SetByteValue(reinterpret_cast<const char*>(stored.data()),
                        gdcm::VL(static_cast<std::uint32_t>(stored.size())));
  fragments->AddFragment(fragment);
  gdcm::DataElement in(gdcm::Tag(0x7fe0, 0x0010)), decoded;
  in.SetVR(gdcm::VR::OB);
  in.SetValue(*fragments);
  bool done = false;
  if (image.syntax.coding == FrameCoding::jpeg)
    done = decode_by<gdcm::JPEGCodec>(image, in, decoded);
  else if (image.syntax.coding == FrameCoding::jpeg_ls)
    done = decode_by<gdcm::JPEGLSCodec>(image, in, decoded);
  else
    done = decode_by<gdcm::JPEG2000Codec>(image, in, decoded);
  const gdcm::ByteValue* bytes = done ? decoded.GetByteValue() : nullptr;
  if (bytes == nullptr || bytes->GetLength() < out.size()) return false;
  std::memcpy(out.data(), bytes->GetPointer(), out.size());
  return true;
}

// GDCM is built with its assertions in Debian, and ends the process over damaged streams.
void decode_stream(const DicomImage& image, const std::string& where, Stored stored,
                   std::span<std::byte> out) {
  if (stored.size() > std::numeric_limits<std::uint32_t>::max() - 1)
    fail(where, "its compressed image is larger than 4 GiB");
  check_stream(image, where, stored);
  std::string why;
  const auto decode = [&](std::span<std::byte> to) { return decode_by_gdcm(image, stored, to); };
  if (!work_apart(out, decode, why))
    fail(where, fmt::format("its {} stream cannot be decoded{}: the file is damaged: copy it again",
                            image.syntax.name, why.empty() ? "" : " (" + why + ")"));
}

}  // namespace

void check_ratio(const DicomImage& image, const std::string& where, std::uint64_t stored) {
  // As much as deflate can make of a byte; an image of one value may be smaller still.
  constexpr std::uint64_t most_of_a_byte = 1032, always = std::uint64_t{64} << 20;
  if (image.frame_bytes() > std::max(always, most_of_a_byte * stored))
    fail(where, fmt::format("{} bytes of samples cannot come from {} compressed ones",
                            image.frame_bytes(), stored));
}

void decode_frame(const DicomImage& image, const std::string& where,
                  std::span<const std::byte> stored, std::span<std::byte> out) {
  if (image.syntax.coding == FrameCoding::run_lengths)
    decode_runs(image, where, stored, out);
  else
    decode_stream(image, where, stored, out);
}

std::uint64_t decoder_bytes(const DicomImage& image) {
  const std::uint64_t samples = static_cast<std::uint64_t>(image.rows * image.columns);
  switch (image.syntax.coding) {
    case FrameCoding::native:
    case FrameCoding::run_lengths:
    case FrameCoding::unknown:
      return 0;
    case FrameCoding::jpeg:
    case FrameCoding::jpeg_ls:
      return 4 * image.frame_bytes();  // streams and copies of them
    case FrameCoding::jpeg_2000:
      break;
  }
  return 4 * image.frame_bytes() + 12 * samples;  // wavelets of 4 bytes, and their code blocks
}

}  // namespace voxweld
