#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include "storage/support/byte_order.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/volumes/data_layout.h"
#include "storage/volumes/decoded_stream.h"
#include "storage/volumes/inflate_stream.h"

namespace voxweld {
namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 16;

// The samples of one part, first to last, as native bytes.
class PartStream {
 public:
  virtual ~PartStream() = default;
  // Exactly out.size() bytes, a multiple of the sample size.
  virtual void read(std::span<std::byte> out) = 0;
  // Called once after the last sample: verifies what can be verified only at the end.
  virtual void finish() {}
};

class PackedPart final : public PartStream {
 public:
  // bytes: of the part's samples; width: of one.
  PackedPart(const DataLayout::Part& part, const DataLayout& layout, std::uint64_t bytes,
             std::size_t width)
      : file_(part.path),
        part_(part),
        encoding_(layout.encoding),
        stream_(open_decoded(encoding_, file_, part_)),
        byte_order_(layout.byte_order),
        bytes_(bytes),
        width_(width) {
    std::uint64_t skip = static_cast<std::uint64_t>(layout.skip_bytes);
    if (layout.samples_at_end) skip = decoded_size() - bytes;
    discard(skip);
  }

  void read(std::span<std::byte> out) override {
    if (stream_->read_some(out) < out.size()) fail_short(stream_->decoded());
    to_native(out.data(), out.size() / width_, width_, byte_order_);
  }

  // The checksum stands at the end of the stream. Bytes beyond the samples are let pass.
  void finish() override {
    std::vector<std::byte> block(block_bytes);
    while (stream_->read_some(block) > 0) {
    }
  }

 private:
  [[noreturn]] void fail_short(std::uint64_t decoded) const {
    throw FormatError(
        fmt::format("{}: the compressed stream ends after {} decoded bytes, {} of samples were "
                    "announced: correct the sizes or get a complete copy",
                    file_.path(), decoded, bytes_));
  }

  // A pass over the whole stream: there is no other way to know where its last bytes start.
  std::uint64_t decoded_size() const {
    const auto stream = open_decoded(encoding_, file_, part_);
    DecodedStream& pass = *stream;
    std::vector<std::byte> block(block_bytes);
    while (pass.read_some(block) > 0) {
    }
    if (pass.decoded() < bytes_) fail_short(pass.decoded());
    return pass.decoded();
  }

  void discard(std::uint64_t count) {
    std::vector<std::byte> block(block_bytes);
    while (count > 0) {
      const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(count, block.size()));
      if (stream_->read_some(std::span(block).first(step)) < step) fail_short(stream_->decoded());
      count -= step;
    }
  }

  ReadFile file_;
  DataLayout::Part part_;
  DataEncoding encoding_;
  std::unique_ptr<DecodedStream> stream_;
  std::endian byte_order_;
  std::uint64_t bytes_;
  std::size_t width_;
};

class TextPart final : public PartStream {
 public:
  TextPart(const DataLayout::Part& part, std::uint64_t skip_bytes, SampleType type)
      : file_(part.path),
        at_(part.offset + skip_bytes),
        end_(std::min(file_.size(), part.offset + part.stored_bytes.value_or(file_.size()))),
        type_(type) {}

  void read(std::span<std::byte> out) override {
    dispatch_sample_type(type_, [&](auto tag) {
      using T = typename decltype(tag)::type;
      for (std::size_t i = 0; i < out.size(); i += sizeof(T)) {
        const T value = parse<T>(next_word());
        std::memcpy(out.data() + i, &value, sizeof(T));
        ++samples_;
      }
    });
  }

 private:
  template <class T>
  T parse(std::string_view word) const {
    T value{};
    if (word.size() > 1 && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size())
      throw FormatError(
          fmt::format("{}: sample {} (counted from 0): expected a number of type {}, "
                      "found '{}'",
                      file_.path(), samples_, sample_type_name(type_), word.substr(0, 40)));
    return value;
  }

  int next_char() {  // -1 at the end
    if (used_ == block_.size()) {
      const std::uint64_t rest = at_ < end_ ? end_ - at_ : 0;
      if (rest == 0) return -1;
      block_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(rest, block_bytes)));
      file_.read(at_, block_);
      at_ += block_.size();
      used_ = 0;
    }
    return std::to_integer<int>(block_[used_++]);
  }

  std::string_view next_word() {
    const auto separates = [](int c) { return c == ',' || c == ' ' || (c >= '\t' && c <= '\r'); };
    int c = next_char();
    while (separates(c)) c = next_char();
    if (c < 0)
      throw FormatError(
          fmt::format("{}: truncated: the text ends after {} samples, the header "
                      "announces more: correct the sizes or get a complete copy",
                      file_.path(), samples_));
    word_.clear();
    for (; c >= 0 && !separates(c) && word_.size() < 400; c = next_char())
      word_ += static_cast<char>(c);
    return word_;
  }

  ReadFile file_;
  std::uint64_t at_, end_;
  SampleType type_;
  std::uint64_t samples_ = 0;
  std::vector<std::byte> block_;
  std::size_t used_ = 0;
  std::string word_;
};

class StreamSource final : public SampleSource {
 public:
  StreamSource(VolumeInfo info, const DataLayout& layout)
      : info_(std::move(info)), layout_(layout), width_(sample_bytes(info_.type)) {
    info_.access = Access::stream;
    const bool small =
        layout.encoding == DataEncoding::deflated || layout.encoding == DataEncoding::text;
    info_.largest_decode = (small ? inflate_memory_bytes : decoder_memory_bytes) + 2 * block_bytes;
    const Index3 size = info_.geometry.size;
    slice_bytes_ = static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y) * width_;
    part_bytes_ = slice_bytes_ * static_cast<std::uint64_t>(size.z) / layout_.parts.size();
  }

  const VolumeInfo& info() const override { return info_; }

  void read(const Box3& box, std::byte* out) const override {
    require_inside(box, info_);
    const Index3 size = info_.geometry.size;
    const bool slices = box.size().y == size.y;
    if (box.size().x != size.x || (!slices && box.size().z != 1))
      throw std::logic_error("a compressed volume is read by whole slices or rows of one");
    const std::uint64_t row = static_cast<std::uint64_t>(size.x) * width_;
    const std::uint64_t begin = static_cast<std::uint64_t>(box.lo.z) * slice_bytes_ +
                                static_cast<std::uint64_t>(box.lo.y) * row;
    if (broken_ || begin < position_) restart();
    // Until the read has ended well, the stream stands nowhere known.
    broken_ = true;
    std::vector<std::byte> skipped(begin > position_ ? block_bytes : 0);
    while (position_ < begin)
      advance(std::span(skipped).first(
          static_cast<std::size_t>(std::min<std::uint64_t>(begin - position_, skipped.size()))));
    advance({out, static_cast<std::size_t>(box.count()) * width_});
    broken_ = false;
  }

 private:
  void restart() const {
    position_ = 0;
    part_.reset();
  }

  // Parts are opened when their first byte is asked for and closed after their last.
  void advance(std::span<std::byte> out) const {
    while (!out.empty()) {
      const std::uint64_t index = position_ / part_bytes_;
      if (!part_) part_ = open_part(static_cast<std::size_t>(index));
      const std::uint64_t end = (index + 1) * part_bytes_;
      const auto count =
          static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), end - position_));
      part_->read(out.first(count));
      out = out.subspan(count);
      position_ += count;
      if (position_ == end) {
        part_->finish();
        part_.reset();
      }
    }
  }

  std::unique_ptr<PartStream> open_part(std::size_t index) const {
    const DataLayout::Part& part = layout_.parts[index];
    if (layout_.encoding == DataEncoding::text)
      return std::make_unique<TextPart>(part, static_cast<std::uint64_t>(layout_.skip_bytes),
                                        info_.type);
    return std::make_unique<PackedPart>(part, layout_, part_bytes_, width_);
  }

  VolumeInfo info_;
  DataLayout layout_;
  std::size_t width_;
  std::uint64_t slice_bytes_, part_bytes_;
  // One reader at a time (Access::stream), so that read() may move on the stream.
  mutable std::uint64_t position_ = 0;  // in bytes of samples
  mutable bool broken_ = false;
  mutable std::unique_ptr<PartStream> part_;
};

}  // namespace

std::unique_ptr<SampleSource> make_stream_source(VolumeInfo info, const DataLayout& layout) {
  return std::make_unique<StreamSource>(std::move(info), layout);
}

}  // namespace voxweld
