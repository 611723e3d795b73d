#include "storage/image/stack_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <list>
#include <mutex>

#include "storage/image/image_file.h"
#include "storage/image/slice_files.h"
#include "storage/image/stack_calibration.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t max_open_files = 2;

std::string describe_pixels(const ImagePage& page) {
  return fmt::format("{} x {} pixels, {} channel{} of {} ({} bits stored)", page.width, page.height,
                     page.channels, page.channels == 1 ? "" : "s", sample_type_name(page.type),
                     page.stored_bits);
}

void refuse_colour(const std::string& path, const ImagePage& page) {
  if (page.palette)
    throw FormatError(
        fmt::format("{}: a palette (indexed colour) image, whose indices are not grey values; "
                    "expected one grey "
                    "channel: convert the slices to grey (in ImageJ: Image > Type > 8-bit)",
                    path));
  if (page.channels != 1)
    throw FormatError(fmt::format(
        "{}: has {} channels ({}); expected one grey channel: convert the slices to grey, or save "
        "the channel to be meshed by itself",
        path, page.channels,
        page.channels == 2   ? "grey and alpha?"
        : page.channels == 3 ? "RGB?"
                             : "RGBA or CMYK?"));
}

struct PageName {
  std::string path;
  std::size_t page = 0;
  bool paged = false;
  std::string text() const { return paged ? fmt::format("{}, page {}", path, page + 1) : path; }
};

void check_alike(const ImagePage& page, const PageName& name, const ImagePage& first,
                 const std::string& first_path) {
  if (page.width == first.width && page.height == first.height && page.type == first.type &&
      page.channels == first.channels && page.stored_bits == first.stored_bits)
    return;
  throw FormatError(
      fmt::format("{}: {}; expected {}, as in {}{}; all slices of a stack must be alike: remove it "
                  "or convert it",
                  name.text(), describe_pixels(page), describe_pixels(first), first_path,
                  name.paged ? ", page 1" : ""));
}

std::vector<std::string> page_warnings(const std::string& path, const ImagePage& page) {
  std::vector<std::string> warnings;
  const int type_bits = static_cast<int>(8 * sample_bytes(page.type));
  const bool is_integer = page.type != SampleType::f32 && page.type != SampleType::f64;
  if (is_integer && !page.rescaled && page.stored_bits < type_bits)
    warnings.push_back(fmt::format("{}: samples of {} bits are kept as {}, values 0 to {}", path,
                                   page.stored_bits, sample_type_name(page.type),
                                   (std::uint64_t{1} << page.stored_bits) - 1));
  if (page.rescaled)
    warnings.push_back(
        fmt::format("{}: samples of {} bits are stretched to the range of {}; isovalues mean the "
                    "stretched values",
                    path, page.stored_bits, sample_type_name(page.type)));
  if (page.white_is_zero)
    warnings.push_back(fmt::format(
        "{}: stored with white as zero; integer values are turned so that brighter is larger",
        path));
  if (page.orientation != 1)
    warnings.push_back(
        fmt::format("{}: its orientation tag ({}) is ignored; rows are taken as stored", path,
                    page.orientation));
  if (page.format == "jpeg")
    warnings.push_back(fmt::format("{}: JPEG is lossy; its blocks show in the surface", path));
  return warnings;
}

class StackSource final : public SampleSource {
 public:
  explicit StackSource(const InputSpec& spec);

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override;

 private:
  void add_pages(ImageFile& file);
  void add_slices(const std::vector<std::filesystem::path>& paths, ImageFile& first);
  void set_geometry(const InputSpec& spec, std::int64_t slices);
  ImageFile& opened(std::size_t file) const;

  VolumeInfo info_;
  ImagePage first_;
  bool paged_ = false;  // one file with a page a slice

  struct OpenFile {
    std::size_t index;
    std::unique_ptr<ImageFile> file;
  };
  // Most recently used first. Bounded: a stack may have more slices than the process descriptors.
  mutable std::list<OpenFile> open_;
  mutable std::mutex reading_;
};

StackSource::StackSource(const InputSpec& spec) {
  info_.format = "stack";
  info_.access = Access::slice;
  SliceFiles found = find_slices(spec.path);
  SliceFiles ordered = order_slices(std::move(found.paths));
  info_.warnings = std::move(found.warnings);
  info_.warnings.insert(info_.warnings.end(), ordered.warnings.begin(), ordered.warnings.end());

  ImageFile first(ordered.paths.front());
  first_ = first.pages().front();
  refuse_colour(first.path(), first_);
  info_.type = first_.type;
  paged_ = ordered.paths.size() == 1 && first.pages().size() > 1;
  if (paged_)
    add_pages(first);
  else
    add_slices(ordered.paths, first);

  const std::vector<std::string> more = page_warnings(first.path(), first_);
  info_.warnings.insert(info_.warnings.end(), more.begin(), more.end());
  set_geometry(spec, static_cast<std::int64_t>(paged_ ? first.pages().size() : info_.files.size()));
}

void StackSource::add_pages(ImageFile& file) {
  info_.files = {file.file()};
  for (std::size_t p = 0; p < file.pages().size(); ++p) {
    const ImagePage& page = file.pages()[p];
    check_alike(page, {file.path(), p, true}, first_, file.path());
    info_.largest_decode = std::max(info_.largest_decode, page.decode_bytes);
  }
}

void StackSource::add_slices(const std::vector<std::filesystem::path>& paths, ImageFile& first) {
  const auto add = [&](ImageFile& file) {
    const ImagePage& page = file.pages().front();
    if (file.pages().size() != 1)
      throw FormatError(
          fmt::format("{}: has {} pages; expected one image in each slice file, or one multi-page "
                      "file by itself",
                      file.path(), file.pages().size()));
    check_alike(page, {file.path(), 0, false}, first_, first.path());
    info_.files.push_back(file.file());
    info_.largest_decode = std::max(info_.largest_decode, page.decode_bytes);
  };
  info_.files.reserve(paths.size());
  add(first);
  for (std::size_t i = 1; i < paths.size(); ++i) {
    ImageFile file(paths[i]);
    add(file);
  }
}

void StackSource::set_geometry(const InputSpec& spec, std::int64_t slices) {
  info_.geometry.size = {first_.width, first_.height, slices};
  StackCalibration calibration = read_calibration(
      first_,
      {info_.files.front().path, info_.files.size() == 1 ? static_cast<std::size_t>(slices) : 0});
  if (spec.spacing) {
    info_.geometry.spacing = *spec.spacing;
    info_.geometry.unit = spec.unit;
    return;
  }
  info_.warnings.insert(info_.warnings.end(), calibration.warnings.begin(),
                        calibration.warnings.end());
  info_.geometry.spacing = calibration.spacing.value_or(Vec3{1, 1, 1});
  info_.geometry.unit = spec.unit.empty() ? calibration.unit : spec.unit;
}

ImageFile& StackSource::opened(std::size_t index) const {
  const auto found = std::find_if(open_.begin(), open_.end(),
                                  [&](const OpenFile& entry) { return entry.index == index; });
  if (found != open_.end()) {
    open_.splice(open_.begin(), open_, found);
    return *open_.front().file;
  }
  if (open_.size() >= max_open_files) open_.pop_back();
  const InputFile& known = info_.files[index];
  auto file = std::make_unique<ImageFile>(known.path);
  if (file->file().state != known.state)
    throw FormatError(known.path + ": changed while it was being read; run again");
  open_.push_front({index, std::move(file)});
  return *open_.front().file;
}

void StackSource::read(const Box3& box, std::byte* out) const {
  assert(!box.empty() && box.lo.x == 0 && box.hi.x == info_.geometry.size.x);
  const std::lock_guard lock(reading_);
  const std::size_t bytes =
      static_cast<std::size_t>(box.size().x * box.size().y) * sample_bytes(info_.type);
  for (std::int64_t z = box.lo.z; z < box.hi.z; ++z) {
    const auto slice = static_cast<std::size_t>(z);
    opened(paged_ ? 0 : slice)
        .read_rows(paged_ ? slice : 0, box.lo.y, box.hi.y, std::span(out, bytes));
    out += bytes;
  }
}

Match test_stack(const InputProbe& probe) {
  const std::string path = probe.path.string();
  return probe.is_directory || is_pattern(path) || has_image_name(probe.path) ? Match::extension
                                                                              : Match::none;
}

}  // namespace

std::unique_ptr<SampleSource> open_stack(const InputSpec& spec) {
  return std::make_unique<StackSource>(spec);
}

VolumeReader stack_reader() {
  return {"stack", "a folder or pattern of images, a multi-page .tif", test_stack, open_stack};
}

}  // namespace voxweld
