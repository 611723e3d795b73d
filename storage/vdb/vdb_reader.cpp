#include "storage/vdb/vdb_reader.h"

#include <cstring>

namespace voxweld {
namespace {

Match test_vdb(const InputProbe& probe) {
  constexpr char magic[] = " BDV\0\0\0";  // 0x56444220 as an integer of 64 bits
  if (probe.head.size() >= sizeof magic && std::memcmp(probe.head.data(), magic, sizeof magic) == 0)
    return Match::contents;
  return probe.is_file && probe.extension == ".vdb" ? Match::extension : Match::none;
}

}  // namespace

VolumeReader vdb_reader() {
  return {.name = "vdb",
          .files = ".vdb",
          .test = test_vdb,
          .module = "vdb",
          .library = "OpenVDB (Debian: libopenvdb-dev)",
          .selects = {Selector::dataset}};
}

}  // namespace voxweld
