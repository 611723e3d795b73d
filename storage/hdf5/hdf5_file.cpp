#include "storage/hdf5/hdf5_file.h"

#include <fmt/format.h>

#include <array>
#include <cstring>

#include "storage/support/error.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

// Called where a link leads into another file. Below 0: it is not followed.
herr_t refuse_external(const char* /*parent_file*/, const char* /*parent_group*/,
                       const char* /*file*/, const char* /*object*/, unsigned* /*flags*/,
                       hid_t /*access*/, void* met) {
  *static_cast<bool*>(met) = true;
  return -1;
}

const std::string& regular(const std::string& path) {
  require_input_file(path);
  return path;
}

// Names what the file is instead, where that is one of the two that go by the same names.
std::string other_format(const ReadFile& file) {
  std::array<char, 4> head{};
  if (file.size() >= head.size()) file.read(0, std::as_writable_bytes(std::span(head)));
  if (std::memcmp(head.data(), "\x0e\x03\x13\x01", 4) == 0)
    return "it is an HDF4 file: convert it by h4toh5";
  if (std::memcmp(head.data(), "CDF", 3) == 0)
    return "it is a NetCDF file of the classic kind (as of MINC 1): convert it to HDF5, of MINC by "
           "mincconvert -2";
  return "expected the signature of HDF5 at byte 0, 512, 1024 or a later power of two";
}

Hdf5Handle open_file(const ReadFile& file) {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // Files on read-only and network disks cannot be locked, and nothing is written.
  H5Pset_file_locking(access.get(), false, true);
  const char* path = file.path().c_str();
  if (H5Fis_hdf5(path) <= 0)
    throw FormatError(fmt::format("{}: not an HDF5 file: {}", path, other_format(file)));
  Hdf5Handle opened(H5Fopen(path, H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (!opened) fail_hdf5(path, "a damaged HDF5 file; get a complete copy");
  return opened;
}

}  // namespace

Hdf5File::Hdf5File(const std::string& path, bool follow) : file_(regular(path)), follow_(follow) {
  const Hdf5Lock lock;
  id_ = open_file(file_);
  link_access_ = {H5Pcreate(H5P_LINK_ACCESS), H5Pclose};
  dataset_access_ = {H5Pcreate(H5P_DATASET_ACCESS), H5Pclose};
  // Data files are looked for beside the file and not where the program runs.
  H5Pset_efile_prefix(dataset_access_.get(), "${ORIGIN}");
  // Chunks are kept by whoever reads them.
  H5Pset_chunk_cache(dataset_access_.get(), 0, 0, 1);
  static bool ignored = false;
  if (follow_) return;
  H5Pset_elink_cb(link_access_.get(), refuse_external, &ignored);
  H5Pset_elink_cb(dataset_access_.get(), refuse_external, &ignored);
}

std::string Hdf5File::where(const std::string& kind, const std::string& path_in_file) const {
  return fmt::format("{}: {} '{}'", path(), kind, path_in_file);
}

Hdf5Handle Hdf5File::open_group(hid_t base, const std::string& path) const {
  Hdf5Handle object(H5Oopen(base, path.c_str(), link_access()), H5Oclose);
  if (object && H5Iget_type(object.get()) == H5I_GROUP) return object;
  return {};
}

// Only H5Dopen takes what says how data files are found. It refuses a dataset that is open already
// without that, so what it is is looked up first.
Hdf5Handle Hdf5File::open_dataset(hid_t base, const std::string& path) const {
  H5O_info_t info;
  if (H5Oget_info_by_name2(base, path.c_str(), &info, H5O_INFO_BASIC, link_access()) < 0 ||
      info.type != H5O_TYPE_DATASET)
    return {};
  return {H5Dopen2(base, path.c_str(), dataset_access_.get()), H5Dclose};
}

bool Hdf5File::met_external_link(hid_t base, const std::string& path) const {
  bool met = false;
  const Hdf5Handle access(H5Pcreate(H5P_LINK_ACCESS), H5Pclose);
  H5Pset_elink_cb(access.get(), refuse_external, &met);
  const Hdf5Handle object(H5Oopen(base, path.c_str(), access.get()), H5Oclose);
  return met;
}

}  // namespace voxweld
