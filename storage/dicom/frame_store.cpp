#include "storage/dicom/frame_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "storage/dicom/compressed_frame.h"
#include "storage/dicom/sample_bits.h"
#include "storage/support/byte_order.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t decoded_frames = 2;
constexpr std::size_t most_fragments = std::size_t{1} << 20;

std::string frame_name(const DicomImage& image, std::size_t frame) {
  return image.frames.size() == 1 ? image.file.path
                                  : fmt::format("{}, frame {}", image.file.path, frame + 1);
}

}  // namespace

FrameStore::OpenImage& FrameStore::open(std::size_t index) {
  if (open_ && open_->index == index) return *open_;
  open_.reset();
  const DicomImage& image = images_[index];
  auto opened = std::make_unique<OpenImage>(OpenImage{index, DicomBytes(image.file.path), {}, {}});
  if (opened->bytes.state() != image.file.state)
    throw FormatError(image.file.path + ": changed while it was being read; run again");
  if (image.syntax.deflated) read_dicom_header(opened->bytes);  // which inflates it
  if (image.syntax.coding != FrameCoding::native) list_fragments(*opened);
  open_ = std::move(opened);
  return *open_;
}

// PS3.5, annex A.4: items behind each other, the first of them a table of offsets, maybe empty.
void FrameStore::list_fragments(OpenImage& opened) const {
  const DicomImage& image = images_[opened.index];
  const std::string& path = image.file.path;
  DicomCursor cursor(opened.bytes);
  cursor.at = image.place.offset;
  std::vector<std::byte> offsets;
  std::uint64_t first_item = 0;
  for (bool table = true;; table = false) {
    if (cursor.at == cursor.size() && !table) break;  // the end is missing, which hinders nobody
    const std::uint64_t at = cursor.at;
    const std::uint32_t group = cursor.u16(), tag = (group << 16) | cursor.u16();
    const std::uint64_t length = cursor.u32();
    if (tag == 0xfffee0dd) break;
    if (tag != 0xfffee000 || length > cursor.size() - cursor.at)
      throw FormatError(fmt::format(
          "{}: offset {}: its compressed samples are cut short or damaged: copy the file again",
          path, at));
    if (table) {
      offsets.resize(std::min<std::uint64_t>(length, 4 * image.frames.size()));
      opened.bytes.read(cursor.at, offsets);
      first_item = cursor.at + length;
    } else {
      opened.fragments.push_back({cursor.at, length});
    }
    if (opened.fragments.size() > most_fragments)
      throw FormatError(path + ": its compressed samples are in more than 2^20 fragments");
    cursor.at += length;
  }
  split_frames(opened, offsets, first_item);
}

void FrameStore::split_frames(OpenImage& opened, const std::vector<std::byte>& offsets,
                              std::uint64_t first_item) const {
  const DicomImage& image = images_[opened.index];
  const std::size_t frames = image.frames.size(), pieces = opened.fragments.size();
  std::vector<std::size_t>& begin = opened.frame_begin;
  if (frames == 1) {
    begin = {0, pieces};
  } else if (pieces == frames) {
    for (std::size_t f = 0; f <= frames; ++f) begin.push_back(f);
  } else if (offsets.size() == 4 * frames) {
    for (std::size_t f = 0; f < frames; ++f) {
      const std::uint64_t item =
          first_item + load_as<std::uint32_t>(offsets.data(), 4 * f, image.syntax.order);
      const auto found = std::ranges::lower_bound(opened.fragments, item + 8, {}, &Piece::offset);
      if (found == opened.fragments.end() || found->offset != item + 8 ||
          (f > 0 && begin.back() >= static_cast<std::size_t>(found - opened.fragments.begin())))
        throw FormatError(fmt::format("{}: frame {} does not begin where its table of offsets says",
                                      image.file.path, f + 1));
      begin.push_back(static_cast<std::size_t>(found - opened.fragments.begin()));
    }
    begin.push_back(pieces);
  } else {
    throw FormatError(fmt::format(
        "{}: its {} frames are in {} fragments, and no table says where they begin: convert it "
        "with gdcmconv --raw",
        image.file.path, frames, pieces));
  }
}

const FrameStore::Decoded& FrameStore::decoded(const DicomSlice& slice) {
  const auto found = std::ranges::find_if(decoded_, [&](const Decoded& d) {
    return d.slice.image == slice.image && d.slice.frame == slice.frame;
  });
  if (found != decoded_.end()) {
    decoded_.splice(decoded_.begin(), decoded_, found);
    return decoded_.front();
  }
  if (decoded_.size() >= decoded_frames) decoded_.pop_back();
  OpenImage& opened = open(slice.image);
  const DicomImage& image = images_[slice.image];
  std::vector<std::byte> stored;
  for (std::size_t p = opened.frame_begin[slice.frame]; p < opened.frame_begin[slice.frame + 1];
       ++p) {
    const Piece& piece = opened.fragments[p];
    const std::size_t before = stored.size();
    stored.resize(before + piece.length);
    opened.bytes.read(piece.offset, std::span(stored).subspan(before));
  }
  Decoded fresh{slice, {}};
  const std::string where = frame_name(image, slice.frame);
  if (stored.empty()) throw FormatError(where + ": has no samples: copy the file again");
  check_ratio(image, where, stored.size());
  fresh.samples.resize(image.frame_bytes());
  decode_frame(image, where, stored, fresh.samples);
  settle_bits(fresh.samples.data(), static_cast<std::size_t>(image.rows * image.columns),
              image.bits, std::endian::native);
  decoded_.push_front(std::move(fresh));
  return decoded_.front();
}

void FrameStore::read_rows(const DicomSlice& slice, std::int64_t begin, std::int64_t end,
                           std::byte* out) {
  const DicomImage& image = images_[slice.image];
  const std::uint64_t row = image.frame_bytes() / static_cast<std::uint64_t>(image.rows);
  const std::uint64_t skip = static_cast<std::uint64_t>(begin) * row;
  const std::size_t bytes = static_cast<std::size_t>(end - begin) * row;
  if (image.syntax.coding != FrameCoding::native) {
    std::memcpy(out, decoded(slice).samples.data() + skip, bytes);
    return;
  }
  const std::uint64_t at = image.place.offset + slice.frame * image.frame_bytes() + skip;
  open(slice.image).bytes.read(at, std::span(out, bytes));
  settle_bits(out, static_cast<std::size_t>((end - begin) * image.columns), image.bits,
              image.syntax.order);
}

std::uint64_t FrameStore::largest_bytes(const DicomImage& image) {
  if (image.syntax.deflated) return image.place.offset + image.place.length;
  if (image.syntax.coding == FrameCoding::native) return 0;
  // What is stored of a frame, which is about as much of each.
  const std::uint64_t stored = 2 * (image.place.length / image.frames.size() + 1);
  return decoded_frames * image.frame_bytes() + stored + decoder_bytes(image);
}

}  // namespace voxweld
