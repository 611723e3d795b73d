#include "storage/vtk/byte_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "storage/support/byte_order.h"
#include "storage/support/error.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

class PlainRun final : public ByteRun {
 public:
  explicit PlainRun(FileSpan span) : span_(std::move(span)) {}

  void read(std::uint64_t at, std::span<std::byte> out) const override {
    if (at > most_bytes() || most_bytes() - at < out.size())
      throw FormatError(fmt::format(
          "{}: truncated: {} bytes expected from byte {} on, the data ends at byte {}: get a "
          "complete copy",
          span_.file->path(), out.size(), span_.begin + at, span_.end));
    span_.file->read(span_.begin + at, out);
  }
  std::uint64_t most_bytes() const override { return span_.end - span_.begin; }

 private:
  FileSpan span_;
};

constexpr std::uint8_t no_digit = 255, padding = 254;

constexpr std::array<std::uint8_t, 256> make_digits() {
  std::array<std::uint8_t, 256> digits{};
  digits.fill(no_digit);
  constexpr const char* in_order =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::uint8_t i = 0; i < 64; ++i) digits[static_cast<std::uint8_t>(in_order[i])] = i;
  digits[static_cast<std::uint8_t>('=')] = padding;
  return digits;
}
constexpr std::array<std::uint8_t, 256> base64_digits = make_digits();

class Base64Run final : public ByteRun {
 public:
  explicit Base64Run(FileSpan span) : span_(std::move(span)) {}

  std::uint64_t most_bytes() const override { return (span_.end - span_.begin) / 4 * 3; }

  void read(std::uint64_t at, std::span<std::byte> out) const override {
    constexpr std::size_t groups = std::size_t{1} << 14;
    std::array<std::byte, 4 * groups> text;
    if (at > most_bytes() || most_bytes() - at < out.size()) fail_short(span_.end, out.size());
    auto skip = static_cast<std::size_t>(at % 3);
    std::uint64_t place = span_.begin + at / 3 * 4;
    while (!out.empty()) {
      const std::size_t here = std::min(groups, (skip + out.size() + 2) / 3);
      const auto chars = std::span(text).first(4 * here);
      span_.file->read(place, chars);
      for (std::size_t i = 0; i < here; ++i) {
        std::array<std::byte, 3> three;
        const std::size_t there = decode(chars.data() + 4 * i, three, place + 4 * i);
        const std::size_t wanted = std::min(out.size(), 3 - skip);
        if (skip + wanted > there) fail_short(place + 4 * i, out.size());
        std::memcpy(out.data(), three.data() + skip, wanted);
        out = out.subspan(wanted);
        skip = 0;
      }
      place += chars.size();
    }
  }

 private:
  [[noreturn]] void fail_short(std::uint64_t place, std::size_t missing) const {
    throw FormatError(fmt::format(
        "{}: truncated: the base64 text ends at byte {}, {} decoded bytes short: get a complete "
        "copy or correct the sizes",
        span_.file->path(), place, missing));
  }

  // The bytes in four characters: 3, or fewer in the last ones.
  std::size_t decode(const std::byte* four, std::array<std::byte, 3>& three,
                     std::uint64_t place) const {
    std::uint32_t bits = 0;
    std::size_t count = 3;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint8_t digit = base64_digits[std::to_integer<std::uint8_t>(four[i])];
      const bool pads = digit == padding && i >= 2;
      if (digit == no_digit || (digit == padding && !pads) || (!pads && count < 3))
        throw FormatError(
            fmt::format("{}: byte {}: no base64 character where one was expected: damaged, or "
                        "written with line breaks, which are not supported",
                        span_.file->path(), place + i));
      bits = bits << 6 | (pads ? 0U : digit);
      if (pads) --count;
    }
    for (std::size_t i = 0; i < 3; ++i)
      three[i] = static_cast<std::byte>(bits >> (16 - 8 * i) & 255U);
    return count;
  }

  FileSpan span_;
};

class RunSource final : public SampleSource {
 public:
  RunSource(VolumeInfo info, SampleRun run) : info_(std::move(info)), run_(std::move(run)) {}

  const VolumeInfo& info() const override { return info_; }

  void read(const Box3& box, std::byte* out) const override {
    require_inside(box, info_);
    const Index3 size = info_.geometry.size, part = box.size();
    const std::size_t width = sample_bytes(info_.type);
    const bool rows = part.x == size.x, slices = rows && part.y == size.y;
    // What lies in one piece in the file is read at once.
    const Index3 step{part.x, rows ? part.y : 1, slices ? part.z : 1};
    const auto samples = static_cast<std::size_t>(step.x * step.y * step.z);
    for (std::int64_t z = box.lo.z; z < box.hi.z; z += step.z)
      for (std::int64_t y = box.lo.y; y < box.hi.y; y += step.y) {
        const std::int64_t first = (z * size.y + y) * size.x + box.lo.x;
        run_.bytes->read(run_.skip + static_cast<std::uint64_t>(first) * width,
                         {out, samples * width});
        to_native(out, samples, width, run_.byte_order);
        out += samples * width;
      }
  }

 private:
  VolumeInfo info_;
  SampleRun run_;
};

}  // namespace

std::unique_ptr<ByteRun> plain_run(FileSpan span) {
  return std::make_unique<PlainRun>(std::move(span));
}

std::unique_ptr<ByteRun> base64_run(FileSpan span) {
  return std::make_unique<Base64Run>(std::move(span));
}

std::unique_ptr<SampleSource> run_source(VolumeInfo info, SampleRun run) {
  return std::make_unique<RunSource>(std::move(info), std::move(run));
}

}  // namespace voxweld
