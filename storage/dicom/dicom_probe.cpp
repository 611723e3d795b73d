#include "storage/dicom/dicom_probe.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string_view>
#include <system_error>

#include "storage/support/byte_order.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t probe_bytes = 512;
// Of a folder of any size no more is looked at.
constexpr std::size_t listed_entries = 20'000, opened_files = 32, entered_folders = 16,
                      opened_below = 4;

bool is_upper(std::byte b) {
  return b >= std::byte{'A'} && b <= std::byte{'Z'};
}

// The data element at `at`, as little endian; its whole length in bytes, or 0 where it is none that
// a header begins with.
std::size_t element_bytes(std::span<const std::byte> head, std::size_t at, std::uint32_t& tag) {
  if (at + 8 > head.size()) return 0;
  const auto group = load_as<std::uint16_t>(head.data(), at, std::endian::little);
  const auto element = load_as<std::uint16_t>(head.data(), at + 2, std::endian::little);
  const std::uint32_t next = (std::uint32_t{group} << 16) | element;
  if ((group != 2 && group != 8) || element > 0x3000 || next <= tag) return 0;
  tag = next;
  std::size_t length = 0, begin = 8;
  if (is_upper(head[at + 4]) && is_upper(head[at + 5])) {
    length = load_as<std::uint16_t>(head.data(), at + 6, std::endian::little);
    const std::string_view vr(reinterpret_cast<const char*>(head.data()) + at + 4, 2);
    if (vr == "OB" || vr == "UN" || vr == "SQ") {
      if (length != 0 || at + 12 > head.size()) return 0;
      length = load_as<std::uint32_t>(head.data(), at + 8, std::endian::little);
      begin = 12;
    }
  } else {
    length = load_as<std::uint32_t>(head.data(), at + 4, std::endian::little);
  }
  return length > 1024 || length % 2 != 0 ? 0 : begin + length;
}

bool file_looks_dicom(const fs::path& path) try {
  const ReadFile file(path);
  std::vector<std::byte> head(
      static_cast<std::size_t>(std::min<std::uint64_t>(probe_bytes, file.size())));
  file.read(0, head);
  return looks_dicom(head);
} catch (const Error&) {
  return false;  // not for detection to judge
}

struct Listing {
  std::vector<fs::path> files, folders;  // sorted
};

Listing list_some(const fs::path& folder) {
  Listing listing;
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  for (std::size_t i = 0; !error && entry != fs::directory_iterator() && i < listed_entries; ++i) {
    std::error_code ignored;
    if (!entry->path().filename().string().starts_with('.')) {
      if (entry->is_regular_file(ignored)) listing.files.push_back(entry->path());
      if (entry->is_directory(ignored)) listing.folders.push_back(entry->path());
    }
    entry.increment(error);
  }
  std::ranges::sort(listing.files);
  std::ranges::sort(listing.folders);
  return listing;
}

bool any_dicom(const std::vector<fs::path>& files, std::size_t most) {
  return std::any_of(files.begin(),
                     files.begin() + static_cast<std::ptrdiff_t>(std::min(most, files.size())),
                     file_looks_dicom);
}

bool folder_looks_dicom(const fs::path& folder) {
  const Listing listing = list_some(folder);
  if (any_dicom(listing.files, opened_files)) return true;
  for (std::size_t i = 0; i < std::min(entered_folders, listing.folders.size()); ++i)
    if (any_dicom(list_some(listing.folders[i]).files, opened_below)) return true;
  return false;
}

Match test_dicom(const InputProbe& probe) {
  if (probe.is_directory) return folder_looks_dicom(probe.path) ? Match::contents : Match::none;
  if (!probe.is_file) return Match::none;
  if (looks_dicom(probe.head)) return Match::contents;
  return probe.extension == ".dcm" || probe.extension == ".dicom" ? Match::extension : Match::none;
}

}  // namespace

bool looks_dicom(std::span<const std::byte> head) {
  if (head.size() >= 132 && std::memcmp(head.data() + 128, "DICM", 4) == 0) return true;
  std::size_t at = 0;
  std::uint32_t tag = 0;
  for (int elements = 0; elements < 4; ++elements) {
    const std::size_t bytes = element_bytes(head, at, tag);
    if (bytes == 0) return false;
    at += bytes;
  }
  return true;
}

VolumeReader dicom_reader() {
  VolumeReader reader;
  reader.name = "dicom";
  reader.files = "a folder of DICOM slices, .dcm, DICOMDIR";
  reader.test = test_dicom;
  reader.module = "dicom";
  reader.library = "GDCM (Debian: libgdcm-dev)";
  reader.selects = {Selector::series};
  reader.resamples = true;
  return reader;
}

}  // namespace voxweld
