// A volume as every reader presents it: facts first (VolumeInfo), then samples by box
// (SampleSource). Filters (crop, overrides) wrap a source and are sources themselves.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "storage/types/box.h"
#include "storage/types/file_state.h"
#include "storage/types/sample_type.h"
#include "storage/types/value_scale.h"

namespace voxweld {

// Where the samples lie. The contouring works in the axis-aligned frame spacing * index; files of
// meshes hold first + that, and direction and origin carry it into the scanner's world, which is
// left to writers.
struct VolumeGeometry {
  Index3 size;            // samples a side
  Vec3 spacing{1, 1, 1};  // distance of neighbouring samples, in `unit`, positive
  Vec3 origin{0, 0, 0};   // world position of output coordinate (0, 0, 0), in `unit`
  // direction[a]: the world direction (unit vector) of increasing index along axis a.
  std::array<Vec3, 3> direction{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  // Output coordinates of sample (0, 0, 0): 0, or of a crop those it has in the whole volume. Of a
  // mesh as input they make the output's the mesh's own, multiples of any step of its lattice.
  Vec3 first{0, 0, 0};
  std::string unit;   // "mm", "um", "nm", "m" ...; empty when the file does not say
  std::string space;  // world convention where known: "LPS", "RAS" ...; else empty
};

// How a source can be read without decoding much more than was asked for (DESIGN: reading).
enum class Access : std::uint8_t {
  box,     // any box, from any thread
  chunks,  // the same, but each box costs all chunks that it touches, and these are no small cubes
  rows,    // whole rows of a slice, in bands
  slice,   // whole slices in any order (a compressed slice is one unit)
  stream,  // whole slices, or bands of rows of large ones, rising only (one compressed stream)
};
constexpr const char* access_name(Access access) {
  constexpr const char* names[] = {"box", "chunks", "rows", "slice", "stream"};
  return names[static_cast<std::size_t>(access)];
}

// One of several things of a kind in a file, of which one is read: a series, a level, a channel ...
struct InputChoice {
  std::string selector;  // as the config calls it: "series", "level" ...
  std::string value;     // what chooses it
  std::string text;      // size, spacing, description: what one would choose by
  bool chosen = false;
};

// A surface that the file itself says is in the volume, in real values.
struct KnownSurface {
  double isovalue = 0;
  bool inside_below = false;  // material is where values are lower
};

// One file the volume is made of, as it was when it was opened.
struct InputFile {
  std::string path;
  FileState state;
};

struct VolumeInfo {
  std::string format;  // as its reader is called, "nrrd"; "mesh" or "empty" of solids alone
  SampleType type = SampleType::u8;
  VolumeGeometry geometry;
  ValueScale scale;  // from the samples as stored to the file's real values
  std::optional<KnownSurface> surface;
  Access access = Access::box;
  // The largest piece the reader must hold decoded at once, in bytes, beyond the caller's buffer.
  std::uint64_t largest_decode = 0;
  // Samples a side of the pieces that are decoded whole, of Access::box and chunks; 1: any box costs
  // what it holds. One of the pieces begins at index chunk_first.
  Index3 chunk{1, 1, 1}, chunk_first{0, 0, 0};
  // Whole rows lie one behind the other, so that boxes side by side along x share what the file
  // system reads for each of them. Of Access::box.
  bool row_major = false;
  std::vector<InputFile> files;
  // How many files besides the samples may lie in, of volumes of so many that nobody lists them.
  double piece_files = 0;
  // Where the file holds several volumes: what there is to choose from. `info` lists them.
  std::vector<InputChoice> choices;
  // Things the user should hear about once: ignored fields, assumed units ...
  std::vector<std::string> warnings;
};

// What a source says of itself whose samples are another's, made anew or copied: boxes cost what
// they hold, however the other's lie.
inline VolumeInfo read_by_any_box(VolumeInfo info) {
  info.access = Access::box;
  info.chunk = splat(1);
  info.chunk_first = {};
  info.row_major = false;
  return info;
}

class RangedSource;

using FileVisitor = std::function<void(const std::filesystem::path&)>;

class SampleSource {
 public:
  virtual ~SampleSource() = default;

  virtual const VolumeInfo& info() const = 0;

  // Fills `out` with the samples of `box`, native byte order, x fastest, tightly packed.
  // Preconditions: box not empty and inside [0, size); out holds box.count() samples. Access::slice
  // and stream take boxes of whole rows only (x full); stream takes whole slices, of large ones
  // (large_slice_bytes) bands of rows too, and these rising from call to call.
  // Access::box and chunks may be called from many threads at once; the others from one at a time.
  // Throws FormatError for truncated or corrupt data, StorageError when the system fails.
  virtual void read(const Box3& box, std::byte* out) const = 0;

  // Calls f with each file that samples of the box may lie in and that is not one of info().files:
  // of volumes of so many files that nobody lists them. A file may be missing.
  virtual void each_file(const Box3& /*box*/, const FileVisitor& /*f*/) const {}

  // The same source where it can tell ranges; else null.
  virtual const RangedSource* ranges() const { return nullptr; }
};

// The lowest and highest of some samples. NaNs are left out, and `any_nan` tells of them.
struct ValueRange {
  double lo = 0, hi = 0;
  bool any_nan = false;
  bool empty = true;  // no ordinary sample at all
};
// Of both together; order does not matter.
constexpr ValueRange merge(const ValueRange& a, const ValueRange& b) {
  ValueRange merged = a.empty ? b : a;
  if (!a.empty && !b.empty) {
    merged.lo = std::min(a.lo, b.lo);
    merged.hi = std::max(a.hi, b.hi);
  }
  merged.any_nan = a.any_nan || b.any_nan;
  return merged;
}

// What makes the samples no labels, which are integers as they are stored: a clause behind the
// file's name. Empty where they may be.
std::string no_labels_text(const VolumeInfo& info);

// The range in real values of samples of that range.
inline ValueRange real_range(const ValueRange& stored, const ValueScale& scale) {
  ValueRange real = stored;
  if (stored.empty) return real;
  const double a = scale.real(stored.lo), b = scale.real(stored.hi);
  real.lo = std::min(a, b);
  real.hi = std::max(a, b);
  return real;
}

// A source that can also tell ranges (the brick store). Conservative: may cover more than the box.
class RangedSource : public SampleSource {
 public:
  const RangedSource* ranges() const final { return this; }
  virtual ValueRange range(const Box3& box) const = 0;
};

}  // namespace voxweld
