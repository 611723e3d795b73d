#include "storage/hdf5/hdf5_reader.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace voxweld {
namespace {

constexpr std::array<const char*, 8> extensions = {".h5",  ".hdf5", ".hdf", ".he5",
                                                   ".nxs", ".ims",  ".mnc", ".ilp"};

Match test_hdf5(const InputProbe& probe) {
  constexpr char signature[] = "\x89HDF\r\n\x1a\n";
  constexpr std::size_t bytes = sizeof signature - 1;
  // What comes before it is the user's own.
  for (const std::size_t at : {0U, 512U, 1024U, 2048U})
    if (probe.head.size() >= at + bytes &&
        std::memcmp(probe.head.data() + at, signature, bytes) == 0)
      return Match::contents;
  return probe.is_file && std::ranges::find(extensions, probe.extension) != extensions.end()
             ? Match::extension
             : Match::none;
}

}  // namespace

VolumeReader hdf5_reader() {
  return {.name = "hdf5",
          .files = ".h5, .hdf5, .hdf, .he5, .nxs, .ims, .mnc, .ilp",
          .test = test_hdf5,
          .module = "hdf5",
          .selects = {Selector::dataset, Selector::level, Selector::channel, Selector::time}};
}

}  // namespace voxweld
