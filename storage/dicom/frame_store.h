// The samples of frames, from the files they lie in. One file is open at a time, and the last two
// compressed frames are kept decoded. For one thread.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <span>
#include <vector>

#include "storage/dicom/choose_series.h"
#include "storage/dicom/dicom_bytes.h"
#include "storage/dicom/dicom_image.h"

namespace voxweld {

class FrameStore {
 public:
  // The images must outlive the store and have no objection.
  explicit FrameStore(const std::vector<DicomImage>& images) : images_(images) {}

  // Rows [begin, end) of a frame, native byte order. FormatError where the file is damaged or not
  // what it was when its header was read.
  void read_rows(const DicomSlice& slice, std::int64_t begin, std::int64_t end, std::byte* out);

  // Bytes that it holds at most while it reads one of this image.
  static std::uint64_t largest_bytes(const DicomImage& image);

 private:
  struct Piece {
    std::uint64_t offset = 0, length = 0;
  };
  struct OpenImage {
    std::size_t index;
    DicomBytes bytes;
    std::vector<Piece> fragments;          // of compressed samples, without the table of offsets
    std::vector<std::size_t> frame_begin;  // the first fragment of each frame, and their number
  };
  struct Decoded {
    DicomSlice slice;
    std::vector<std::byte> samples;
  };

  OpenImage& open(std::size_t index);
  void list_fragments(OpenImage& image) const;
  void split_frames(OpenImage& image, const std::vector<std::byte>& offsets,
                    std::uint64_t first_item) const;
  const Decoded& decoded(const DicomSlice& slice);

  const std::vector<DicomImage>& images_;
  std::unique_ptr<OpenImage> open_;
  std::list<Decoded> decoded_;  // latest first
};

}  // namespace voxweld
