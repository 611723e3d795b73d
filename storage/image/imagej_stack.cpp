// Stacks and hyperstacks as ImageJ writes them: pages in the order channel (fastest), slice, frame.
// Over 4 GiB a file has a directory for the first image only, and all others follow it raw.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "storage/image/stack_plan.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

struct ImagejSizes {
  std::int64_t images = 1, channels = 1, slices = 1, frames = 1;
};

std::int64_t imagej_count(const StackStart& start, std::string_view key) {
  const std::string_view text = imagej_value(start.page.description, key);
  if (text.empty()) return 1;
  const std::optional<std::int64_t> count = parse_integer(trim(text));
  if (count && *count >= 1 && *count <= max_files) return *count;
  throw FormatError(fmt::format("{}: the description of ImageJ says {}={:.40}: expected 1 to {}",
                                start.file.path(), key, text, max_files));
}

ImagejSizes imagej_sizes(const StackStart& start) {
  ImagejSizes sizes{imagej_count(start, "images"), imagej_count(start, "channels"),
                    imagej_count(start, "slices"), imagej_count(start, "frames")};
  // Each is at most 2^24.
  const bool plain = sizes.channels == 1 && sizes.slices == 1 && sizes.frames == 1;
  if (plain) sizes.slices = sizes.images;
  const bool whole = sizes.channels * sizes.slices <= max_files &&
                     sizes.channels * sizes.slices * sizes.frames == sizes.images;
  if (whole) return sizes;
  throw FormatError(
      fmt::format("{}: the description of ImageJ says {} images, but {} channels, {} slices and {} "
                  "frames",
                  start.file.path(), sizes.images, sizes.channels, sizes.slices, sizes.frames));
}

// Bytes of an image of a file that has a directory for one of them, and all of them raw.
std::uint64_t raw_image_bytes(const StackStart& start, const ImagejSizes& sizes,
                              const StackPlan& plan) {
  const ImagePage& page = start.page;
  if (!page.raw_offset || plan.level != 0)
    throw FormatError(
        fmt::format("{}: ImageJ wrote {} images here but a directory for one only, which is read "
                    "where the images are grey and not compressed; save it as BigTIFF or as an "
                    "image sequence",
                    start.file.path(), sizes.images));
  const auto image = static_cast<std::uint64_t>(page.width) *
                     static_cast<std::uint64_t>(page.height) * sample_bytes(page.type);
  const std::uint64_t file_bytes = start.file.file().state.size;
  const std::uint64_t room = (file_bytes - std::min(file_bytes, *page.raw_offset)) / image;
  if (room >= static_cast<std::uint64_t>(sizes.images)) return image;
  throw FormatError(
      fmt::format("{}: truncated: ImageJ announces {} images of {} bytes from byte {} on, but "
                  "the file ({} bytes) has room for {}: get a complete copy",
                  start.file.path(), sizes.images, image, *page.raw_offset, file_bytes, room));
}

}  // namespace

void plan_imagej(const StackStart& start, const InputSpec& spec, StackPlan& plan) {
  ImagejSizes sizes = imagej_sizes(start);
  const auto pages = static_cast<std::int64_t>(start.file.page_count());
  if (pages != 1 && pages < sizes.images)
    throw FormatError(fmt::format("{}: has {} pages, but the description of ImageJ says {} images",
                                  start.file.path(), pages, sizes.images));
  if (pages > sizes.images)
    plan.warnings.push_back(
        fmt::format("{}: the last {} of its {} pages are ignored: the description of ImageJ tells "
                    "of {} images",
                    start.file.path(), pages - sizes.images, pages, sizes.images));
  if (sizes.slices == 1 && sizes.frames > 1 && !spec.select.time) {
    plan.warnings.push_back(fmt::format(
        "{}: its {} frames are taken for slices; input.time (--time) takes one of them for itself",
        start.file.path(), sizes.frames));
    std::swap(sizes.slices, sizes.frames);
  }
  const auto nameless = [](std::int64_t) { return std::string(); };
  const std::int64_t channel = choose_channel(start, sizes.channels, {}, spec, plan);
  const std::int64_t time = choose_one({Selector::time, sizes.frames, nameless}, spec, plan);
  plan.paged = true;
  const bool raw = pages == 1 && sizes.images > 1;
  const std::uint64_t image = raw ? raw_image_bytes(start, sizes, plan) : 0;
  for (std::int64_t z = 0; z < sizes.slices; ++z) {
    const auto index =
        static_cast<std::size_t>(channel + sizes.channels * (z + sizes.slices * time));
    plan.planes.push_back({0, raw ? 0 : index});
    if (raw) plan.raw_offsets.push_back(*start.page.raw_offset + index * image);
  }
  plan.calibration = read_calibration(start.page, {start.file.path(), plan.planes.size()});
}

}  // namespace voxweld
