#include "storage/image/ome_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "storage/support/error.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

// Which of the wanted planes a block holds: [begin, end).
struct WantedPart {
  std::int64_t begin = 0, end = 0;
};

WantedPart part_of(const OmeWanted& wanted, std::int64_t start, std::int64_t count) {
  // The first wanted plane at or behind `plane`.
  const auto from = [&](std::int64_t plane) {
    if (plane <= wanted.first) return std::int64_t{0};
    return std::min((plane - wanted.first + wanted.step - 1) / wanted.step, wanted.count);
  };
  return {from(start), from(start + count)};
}

struct FoundPlane {
  std::int64_t place = 0;  // among the wanted
  StackPlane plane;
  bool operator<(const FoundPlane& other) const { return place < other.place; }
};

void refuse_twice(const std::filesystem::path& path, std::int64_t place) {
  throw FormatError(
      fmt::format("{}: the OME-XML names two pages for slice {}", path.string(), place));
}

}  // namespace

std::optional<OmeStrides> ome_strides(const std::string& order, const OmeSizes& sizes) {
  if (order.size() != 5 || !order.starts_with("XY")) return std::nullopt;
  OmeStrides strides{.z = 0, .c = 0, .t = 0};
  std::int64_t stride = 1;
  for (const char axis : order.substr(2)) {
    std::int64_t& place = axis == 'Z' ? strides.z : axis == 'C' ? strides.c : strides.t;
    if (place != 0 || (axis != 'Z' && axis != 'C' && axis != 'T')) return std::nullopt;
    place = stride;
    stride *= axis == 'Z' ? sizes.z : axis == 'C' ? sizes.c : sizes.t;
  }
  return strides;
}

void OmeFiles::allow_renamed(const std::vector<OmeImage>& images,
                             std::vector<std::string>& warnings) {
  if (settings_.own.empty()) return;
  std::set<std::string> names;
  for (const OmeImage& image : images)
    for (const OmePages& pages : image.pages) names.insert(pages.file);
  names.erase("");
  if (names.size() != 1 || *names.begin() == settings_.own.filename()) return;
  std::error_code error;
  if (std::filesystem::exists(settings_.own.parent_path() / *names.begin(), error)) return;
  renamed_ = true;
  warnings.push_back(fmt::format("{}: its OME-XML calls it {}: it is taken for renamed",
                                 settings_.own.string(), *names.begin()));
}

std::size_t OmeFiles::add(const std::filesystem::path& path) {
  const auto [found, is_new] = by_path_.try_emplace(path.string(), paths_.size());
  if (is_new) paths_.push_back(path);
  return found->second;
}

std::size_t OmeFiles::find(const OmePages& pages) {
  const bool unnamed = pages.file.empty();
  const bool is_own = renamed_ || (unnamed && pages.uuid.empty()) ||
                      (!pages.uuid.empty() && pages.uuid == settings_.own_uuid) ||
                      (!unnamed && pages.file == settings_.own.filename());
  if (is_own && !settings_.own.empty()) return add(settings_.own);
  const std::string where = settings_.metadata.string() + ": its OME-XML";
  if (unnamed)
    throw FormatError(fmt::format("{} has pages in a file that it does not name (UUID '{:.80}')",
                                  where, pages.uuid));
  const std::filesystem::path path = named_data_file(
      {.path = settings_.metadata.string(), .follow = settings_.follow}, pages.file, where);
  if (by_path_.contains(path.string())) return add(path);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw FormatError(
        fmt::format("{} names the file {}, which is missing: copy all files of the "
                    "data set into one folder",
                    where, path.string()));
  return add(path);
}

std::int64_t OmeFiles::page_count(std::size_t file) {
  const auto [count, is_new] = page_counts_.try_emplace(file, 0);
  if (is_new) count->second = static_cast<std::int64_t>(ImageFile(paths_[file]).page_count());
  return count->second;
}

std::vector<StackPlane> find_ome_planes(const std::vector<OmePages>& blocks, const OmeImage& image,
                                        const OmeWanted& wanted, OmeFiles& files) {
  std::vector<FoundPlane> found;
  const std::filesystem::path& first_path = files.paths().front();
  const std::int64_t planes_c = wanted.total / (image.z * image.t);
  const OmeStrides strides = *ome_strides(image.order, {.z = image.z, .c = planes_c, .t = image.t});
  for (const OmePages& block : blocks) {
    if (block.z >= image.z || block.c >= planes_c || block.t >= image.t)
      throw FormatError(fmt::format(
          "{}: the OME-XML has pages for z {}, channel {}, time {}, but only {}, {} and {} of them",
          first_path.string(), block.z, block.c, block.t, image.z, planes_c, image.t));
    const std::int64_t start = block.z * strides.z + block.c * strides.c + block.t * strides.t;
    const std::int64_t page = block.page.value_or(0);
    std::int64_t count = block.page ? 1 : wanted.total;
    if (block.count) count = *block.count;
    // Of a file all of whose pages are meant.
    if (!block.page && !block.count) count = files.page_count(files.find(block));
    const WantedPart part = part_of(wanted, start, std::min(count, wanted.total - start));
    if (part.begin >= part.end) continue;
    const std::size_t file = files.find(block);
    const auto page_of = [&](std::int64_t place) {
      return page + wanted.first + place * wanted.step - start;
    };
    if (page_of(part.end - 1) >= files.page_count(file))
      throw FormatError(fmt::format("{}: has {} pages, but the OME-XML names page {}",
                                    files.path(file).string(), files.page_count(file),
                                    page_of(part.end - 1) + 1));
    if (static_cast<std::int64_t>(found.size()) + part.end - part.begin > wanted.count)
      refuse_twice(first_path, part.begin);
    for (std::int64_t place = part.begin; place < part.end; ++place)
      found.push_back({place, {file, static_cast<std::size_t>(page_of(place))}});
  }
  std::sort(found.begin(), found.end());
  std::vector<StackPlane> planes;
  for (const FoundPlane& one : found) {
    const auto next = static_cast<std::int64_t>(planes.size());
    if (one.place < next) refuse_twice(first_path, one.place);
    if (one.place > next) break;
    planes.push_back(one.plane);
  }
  if (static_cast<std::int64_t>(planes.size()) < wanted.count)
    throw FormatError(fmt::format("{}: the OME-XML names no page for slice {} of {}",
                                  first_path.string(), planes.size(), wanted.count));
  return planes;
}

}  // namespace voxweld
