// How a header says its samples are stored, and the sources that read them so. NRRD, MetaImage,
// NIfTI, Inrimage and raw files differ in their headers only: what they say about the data ends up
// here.
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "storage/types/volume_reader.h"

namespace voxweld {

enum class DataEncoding {
  raw,       // the samples' bytes
  deflated,  // the same in a gzip or zlib stream
  bzip2,     // in a bzip2 stream
  byte_rle,  // in runs of bytes: n < 128 and a byte to repeat n times, or 128 + n and n bytes
  text,      // numbers separated by blanks or commas
};

struct DataLayout {
  // The samples in order, x fastest, cut into equal shares, one for each part.
  struct Part {
    std::filesystem::path path;
    std::uint64_t offset = 0;  // of the first stored byte in the file
    int skip_lines = 0;        // lines of text from there to the first stored byte
    // From `offset` on, where the header says how many are its own: others may follow. Unset: all
    // that is left of the file.
    std::optional<std::uint64_t> stored_bytes{};
  };
  std::vector<Part> parts;
  DataEncoding encoding = DataEncoding::raw;
  std::endian byte_order = std::endian::little;  // of the samples; nothing to `text`
  // Bytes before the samples once decoded (not of text); unset: the samples end the data.
  std::int64_t skip_bytes = 0;
  bool samples_at_end = false;
  // What the message about a missing data file points at: "scan.mhd:9: field 'ElementDataFile'".
  std::string named_by;
};

// Of a stream whose slices are larger, bands of rows are read, so that no slice is held whole.
inline constexpr std::uint64_t large_slice_bytes = std::uint64_t{64} << 20;

// Bytes of all samples. FormatError "<where>: ..." unless every size is positive and the product
// fits 62 bits.
std::uint64_t checked_volume_bytes(Index3 size, SampleType type, const std::string& where);

// The data file that the header spec.path names at `where`. FormatError where its name is an
// absolute path or leads out of the header's folder, unless spec.follow: who writes a header must
// not choose which of the reader's files are read. Symbolic links are the user's own business.
std::filesystem::path named_data_file(const InputSpec& spec, const std::string& name,
                                      const std::string& where);

// InputError unless `path` is a regular file.
void require_input_file(const std::filesystem::path& path);

// Opens the files of `layout`, adds them to info.files and checks their sizes; sets info.access
// (raw: box; others: stream) and info.largest_decode; more bytes than needed only warn.
// Preconditions: info.format, type and geometry.size are set, parts divide the samples evenly.
// FormatError for missing, truncated or evidently not so encoded data.
std::unique_ptr<SampleSource> open_layout(VolumeInfo info, DataLayout layout);

// The two kinds of source behind open_layout, which has settled and checked the layout before.
// Raw samples: any box, from any thread (Access::box).
std::unique_ptr<SampleSource> make_raw_source(VolumeInfo info, const DataLayout& layout);
// Deflated or text samples: whole slices, or bands of rows of one, rising; a lower one starts again
// at the first sample (Access::stream).
std::unique_ptr<SampleSource> make_stream_source(VolumeInfo info, const DataLayout& layout);

// Throws std::logic_error unless the box is not empty and inside the volume: a bug of the caller.
void require_inside(const Box3& box, const VolumeInfo& info);

}  // namespace voxweld
