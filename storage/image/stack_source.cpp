#include "storage/image/stack_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <list>
#include <map>
#include <mutex>

#include "storage/image/image_file.h"
#include "storage/image/slice_files.h"
#include "storage/image/stack_plan.h"
#include "storage/support/error.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

constexpr std::size_t max_open_files = 2;

std::string describe_pixels(const ImagePage& page) {
  return fmt::format("{} x {} pixels, {} channel{} of {} ({} bits stored{})", page.width,
                     page.height, page.channels, page.channels == 1 ? "" : "s",
                     sample_type_name(page.type), page.stored_bits,
                     page.white_is_zero ? ", white is zero" : "");
}

struct PageName {
  std::string path;
  std::size_t page = 0;
  bool paged = false;
  std::string text() const { return paged ? fmt::format("{}, page {}", path, page + 1) : path; }
};

struct NamedPage {
  const ImagePage& page;
  PageName name;
};

// Where pages differ in white-is-zero, the tag of some is wrong: turning those would spoil the volume.
void check_alike(const ImagePage& page, const PageName& name, const NamedPage& first) {
  const ImagePage& expected = first.page;
  if (page.width == expected.width && page.height == expected.height &&
      page.type == expected.type && page.channels == expected.channels &&
      page.stored_bits == expected.stored_bits && page.white_is_zero == expected.white_is_zero)
    return;
  throw FormatError(fmt::format(
      "{}: {}; expected {}, as in {}; all slices of a stack must be alike: remove it "
      "or convert it",
      name.text(), describe_pixels(page), describe_pixels(expected), first.name.text()));
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
  if (page.palette)
    warnings.push_back(fmt::format(
        "{}: a palette (indexed colour) image; its indices are read and its colours ignored",
        path));
  if (page.format == "jpeg" || page.compression == "jpeg")
    warnings.push_back(fmt::format("{}: JPEG is lossy; its blocks show in the surface", path));
  return warnings;
}

class StackSource final : public SampleSource {
 public:
  StackSource(const InputSpec& spec, StackPlan plan);

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override;
  const StackPlan& plan() const { return plan_; }
  const ImagePage& first() const { return first_; }

 private:
  void add_planes();
  void check_page(const ImagePage& page, const ImageFile& file, std::size_t index);
  void set_geometry(const InputSpec& spec);
  ImageFile& opened(std::size_t file) const;

  VolumeInfo info_;
  StackPlan plan_;   // its planes' files are those of info_.files
  ImagePage first_;  // of the first slice

  struct OpenFile {
    std::size_t index;
    std::unique_ptr<ImageFile> file;
  };
  // Most recently used first. Bounded: a stack may have more slices than the process descriptors.
  mutable std::list<OpenFile> open_;
  mutable std::mutex reading_;
};

StackSource::StackSource(const InputSpec& spec, StackPlan plan) : plan_(std::move(plan)) {
  info_.format = "stack";
  info_.access = Access::slice;
  info_.warnings = std::move(plan_.warnings);
  info_.choices = std::move(plan_.choices);
  add_planes();
  info_.type = first_.type;
  const std::vector<std::string> more = page_warnings(info_.files.front().path, first_);
  info_.warnings.insert(info_.warnings.end(), more.begin(), more.end());
  set_geometry(spec);
}

// Opens the files of all slices, one at a time, and checks that the slices fit together. Files that
// hold none of them are left out.
void StackSource::add_planes() {
  std::map<std::size_t, std::size_t> places;  // of the plan's files in info_.files
  std::size_t now_open = 0;
  std::unique_ptr<ImageFile> file;
  for (StackPlane& plane : plan_.planes) {
    if (!file || now_open != plane.file)
      file = std::make_unique<ImageFile>(plan_.files[plane.file], plan_.level);
    now_open = plane.file;
    if (!plan_.paged && file->page_count() != 1)
      throw FormatError(
          fmt::format("{}: has {} pages; expected one image in each slice file, or one multi-page "
                      "file by itself",
                      file->path(), file->page_count()));
    const ImagePage page = file->page(plane.page);
    if (info_.files.empty()) first_ = page;
    check_page(page, *file, plane.page);
    const auto [place, is_new] = places.try_emplace(plane.file, info_.files.size());
    if (is_new) info_.files.push_back(file->file());
    plane.file = place->second;
    info_.largest_decode = std::max(info_.largest_decode, page.decode_bytes);
    if (!plan_.raw_offsets.empty()) return;
  }
}

void StackSource::check_page(const ImagePage& page, const ImageFile& file, std::size_t index) {
  const std::string& first_path = info_.files.empty() ? file.path() : info_.files.front().path;
  check_alike(page, {file.path(), index, plan_.paged},
              {first_, {first_path, plan_.planes.front().page, plan_.paged}});
}

void StackSource::set_geometry(const InputSpec& spec) {
  info_.geometry.size = {first_.width, first_.height,
                         static_cast<std::int64_t>(plan_.planes.size())};
  checked_volume_bytes(info_.geometry.size, info_.type, info_.files.front().path);
  if (spec.spacing) {
    info_.geometry.spacing = *spec.spacing;
    info_.geometry.unit = spec.unit;
    return;
  }
  StackCalibration& calibration = plan_.calibration;
  info_.warnings.insert(info_.warnings.end(), calibration.warnings.begin(),
                        calibration.warnings.end());
  info_.geometry.spacing = calibration.spacing.value_or(Vec3{1, 1, 1});
  info_.geometry.unit = spec.unit.empty() ? calibration.unit : spec.unit;
  if (plan_.level == 0) return;
  // A smaller resolution covers what the full one does.
  const ImagePage full = ImageFile(info_.files.front().path).page(plan_.planes.front().page);
  info_.geometry.spacing.x *= static_cast<double>(full.width) / static_cast<double>(first_.width);
  info_.geometry.spacing.y *= static_cast<double>(full.height) / static_cast<double>(first_.height);
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
  auto file = std::make_unique<ImageFile>(known.path, plan_.level);
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
    const StackPlane& plane = plan_.planes[static_cast<std::size_t>(z)];
    opened(plane.file)
        .read_rows({static_cast<int>(plane.page), box.lo.y, box.hi.y, plan_.channel},
                   std::span(out, bytes));
    out += bytes;
  }
}

// The slices of a file that lie raw behind each other, read in place.
std::unique_ptr<SampleSource> raw_stack(const StackSource& stack) {
  DataLayout layout;
  layout.byte_order = stack.first().big_endian ? std::endian::big : std::endian::little;
  const VolumeInfo& info = stack.info();
  const Index3 size = info.geometry.size;
  const std::uint64_t slice = static_cast<std::uint64_t>(size.x) *
                              static_cast<std::uint64_t>(size.y) * sample_bytes(info.type);
  const std::vector<std::uint64_t>& offsets = stack.plan().raw_offsets;
  const std::string& path = info.files.front().path;
  if (offsets.back() - offsets.front() == slice * (offsets.size() - 1))
    layout.parts = {{path, offsets.front(), 0}};
  else
    for (const std::uint64_t offset : offsets) layout.parts.push_back({path, offset, 0});
  return make_raw_source(info, layout);
}

Match test_stack(const InputProbe& probe) {
  const std::string path = probe.path.string();
  const bool named = is_pattern(path) || has_image_name(probe.path) || probe.extension == ".ome";
  return probe.is_directory || named ? Match::extension : Match::none;
}

}  // namespace

std::unique_ptr<SampleSource> open_stack(const InputSpec& spec) {
  auto stack = std::make_unique<StackSource>(spec, plan_stack(spec));
  if (!stack->plan().raw_offsets.empty()) return raw_stack(*stack);
  return stack;
}

VolumeReader stack_reader() {
  return {.name = "stack",
          .files = "a folder or pattern of images, a multi-page .tif",
          .test = test_stack,
          .open = open_stack,
          .selects = {Selector::dataset, Selector::level, Selector::channel, Selector::time}};
}

}  // namespace voxweld
