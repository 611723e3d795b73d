#include "storage/dicom/dicom_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <system_error>

#include "storage/dicom/dicom_probe.h"
#include "storage/dicom/element_values.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// Each folder once, whatever links lead to it.
void list_files(const fs::path& folder, std::set<fs::path>& seen, std::vector<fs::path>& files) {
  std::vector<fs::path> entries;
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error))
    if (!entry->path().filename().string().starts_with('.')) entries.push_back(entry->path());
  if (error) throw_errno("list", folder.string(), error.value());
  std::ranges::sort(entries);
  for (const fs::path& path : entries) {
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored)) files.push_back(path);
    if (!fs::is_directory(path, ignored)) continue;
    const fs::path place = fs::canonical(path, ignored);
    if (!ignored && seen.insert(place).second) list_files(path, seen, files);
  }
}

std::vector<fs::path> files_below(const fs::path& folder) {
  std::error_code ignored;
  std::set<fs::path> seen{fs::canonical(folder, ignored)};
  std::vector<fs::path> files;
  list_files(folder, seen, files);
  std::ranges::sort(files);
  return files;
}

bool begins_dicom(const DicomBytes& bytes) {
  std::vector<std::byte> head(static_cast<std::size_t>(std::min<std::uint64_t>(512, bytes.size())));
  bytes.read(0, head);
  return looks_dicom(head);
}

// The files that were passed over, for one warning.
struct Passed {
  std::size_t count = 0;
  std::string first;
  void add(const fs::path& path) {
    if (count++ == 0) first = path.filename().string();
  }
};

// The file that a record of a directory names: its path, cut into parts of at most 8 characters.
fs::path record_file(const InputSpec& spec, std::string name) {
  std::ranges::replace(name, '\\', '/');
  const std::string where = fmt::format("{}: {}", spec.path, tag_text(dicom::referenced_file));
  const fs::path file = named_data_file(spec, name, where);
  // Some systems show the names of a disc in lower case.
  for (const fs::path& path : {file, named_data_file(spec, lower(name), where)}) {
    std::error_code ignored;
    if (!fs::exists(path, ignored)) continue;
    require_input_file(path);
    return path;
  }
  throw InputError(
      fmt::format("{}: names {}, which is not there: copy the whole disc, or name a "
                  "folder of slices instead",
                  where, shown_text(file.string())));
}

// The files that a DICOMDIR names; none where the file is an image.
std::vector<fs::path> directory_files(const InputSpec& spec) {
  DicomBytes bytes(spec.path);
  const DicomHeader header = read_dicom_header(bytes);
  const DicomElement* records = header.data.find(dicom::directory_records);
  std::vector<fs::path> files;
  if (records == nullptr) return files;
  for (const DataSet& record : records->items)
    if (const std::string name = record.text(dicom::referenced_file); !name.empty())
      files.push_back(record_file(spec, name));
  std::ranges::sort(files);
  files.erase(std::unique(files.begin(), files.end()), files.end());
  if (files.empty()) throw InputError(spec.path + ": this DICOM directory names no files");
  return files;
}

void add_images(const std::vector<fs::path>& files, std::vector<DicomImage>& images,
                Passed& passed) {
  for (const fs::path& path : files) {
    DicomBytes bytes(path);
    std::optional<DicomImage> image;
    if (begins_dicom(bytes)) image = read_dicom_image(bytes);
    if (image)
      images.push_back(std::move(*image));
    else
      passed.add(path);
  }
}

}  // namespace

std::vector<DicomImage> find_dicom_images(const InputSpec& spec,
                                          std::vector<std::string>& warnings) {
  std::vector<DicomImage> images;
  Passed passed;
  std::error_code error;
  const bool folder = fs::is_directory(spec.path, error);
  if (!folder) require_input_file(spec.path);
  const std::vector<fs::path> files = folder ? files_below(spec.path) : directory_files(spec);
  if (!folder && files.empty()) {
    DicomBytes bytes(spec.path);
    if (std::optional<DicomImage> image = read_dicom_image(bytes))
      images.push_back(std::move(*image));
    else
      throw FormatError(spec.path +
                        ": a DICOM file without samples: name a file or a folder of slices");
    return images;
  }
  add_images(files, images, passed);
  if (images.empty())
    throw InputError(
        fmt::format("{}: none of its {} files is a DICOM image", spec.path, files.size()));
  if (passed.count > 0)
    warnings.push_back(fmt::format("{}: {} file{} that {} no DICOM image{} {} passed over ({}{})",
                                   spec.path, passed.count, passed.count == 1 ? "" : "s",
                                   passed.count == 1 ? "is" : "are", passed.count == 1 ? "" : "s",
                                   passed.count == 1 ? "is" : "are", passed.first,
                                   passed.count == 1 ? "" : ", ..."));
  return images;
}

}  // namespace voxweld
