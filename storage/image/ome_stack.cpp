// OME-TIFF: which pages of which files hold the planes of an image.
// Based on: the OME-TIFF specification, version 6 (ome-model.readthedocs.io).
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "storage/image/ome_pages.h"
#include "storage/image/stack_plan.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

constexpr double most_planes = 1e12;

OmeMetadata read_ome(const std::string& xml, const std::filesystem::path& path) {
  OmeMetadata metadata;
  std::string error;
  if (!tiff_service().read_ome(xml, metadata, error))
    throw FormatError(fmt::format("{}: its OME-XML cannot be read: {}", path.string(), error));
  return metadata;
}

// The whole metadata, which may be in a file of its own. The UUID stays that of the file at `path`.
OmeMetadata whole_metadata(const std::string& xml, const InputSpec& spec,
                           std::filesystem::path& path) {
  OmeMetadata metadata = read_ome(xml, path);
  if (metadata.images.empty() && !metadata.metadata_file.empty()) {
    const std::string where = path.string() + ": its OME-XML";
    const std::filesystem::path companion = named_data_file(
        {.path = path.string(), .follow = spec.follow}, metadata.metadata_file, where);
    if (!std::filesystem::is_regular_file(companion))
      throw FormatError(
          fmt::format("{} is in {}, which is missing: copy it beside", where, companion.string()));
    OmeMetadata whole = read_ome(read_text_file(companion), companion);
    whole.uuid = metadata.uuid;
    path = companion;
    metadata = std::move(whole);
  }
  if (metadata.images.empty())
    throw FormatError(fmt::format("{}: its OME-XML tells of no image", path.string()));
  return metadata;
}

std::string image_text(const OmeImage& image) {
  return fmt::format("{}{}{} x {} x {} {}, {} channels, {} times", image.name,
                     image.name.empty() ? "" : ": ", image.x, image.y, image.z, image.type, image.c,
                     image.t);
}

// By name, by ID, or by number.
std::optional<std::size_t> find_image(const std::vector<OmeImage>& images,
                                      const std::string& what) {
  std::vector<std::size_t> named;
  for (std::size_t i = 0; i < images.size(); ++i)
    if (images[i].name == what || images[i].id == what) named.push_back(i);
  if (named.size() == 1) return named.front();
  const std::optional<std::int64_t> number = parse_integer(what);
  if (!number || *number < 0 || *number >= static_cast<std::int64_t>(images.size()))
    return std::nullopt;
  return static_cast<std::size_t>(*number);
}

const OmeImage& choose_image(const OmeMetadata& metadata, const InputSpec& spec, StackPlan& plan) {
  const std::string& asked = spec.select.dataset;
  const std::vector<OmeImage>& images = metadata.images;
  const bool open = asked.empty() && images.size() > 1;
  const std::optional<std::size_t> found =
      asked.empty() ? std::optional<std::size_t>(0) : find_image(images, asked);
  std::string there = fmt::format("{}: holds {} images: ", spec.path, images.size());
  for (std::size_t i = 0; i < images.size() && i < 16; ++i)
    there += fmt::format("{}{} ({})", i == 0 ? "" : ", ", i, image_text(images[i]));
  if (images.size() > 16) there += fmt::format(" ... {}", images.size() - 1);
  if (!found) throw InputError(fmt::format("{}; input.dataset (--dataset) is '{}'", there, asked));
  if (open && !spec.survey)
    throw InputError(there + "; set input.dataset or --dataset to the name or number of one");
  if (open)
    plan.warnings.push_back(there +
                            "; shown is image 0: input.dataset (--dataset) chooses another");
  for (std::size_t i = 0; i < images.size() && images.size() > 1; ++i)
    plan.choices.push_back(
        {selector_name(Selector::dataset), std::to_string(i), image_text(images[i]), i == *found});
  return images[*found];
}

void check_page(const StackStart& start, const OmeImage& image, StackPlan& plan) {
  const ImagePage& page = start.page;
  if (page.width != image.x || page.height != image.y || image.c % page.channels != 0)
    throw FormatError(fmt::format(
        "{}, page {}: {} x {} pixels, {} samples each; expected {} x {} and {} channels, as its "
        "OME-XML says",
        start.file.path(), start.index + 1, page.width, page.height, page.channels, image.x,
        image.y, image.c));
  const std::string_view type = sample_type_name(page.type);
  const bool same = type == image.type || (image.type == "float" && type == "float32") ||
                    (image.type == "double" && type == "float64") ||
                    (image.type == "bit" && page.stored_bits == 1);
  if (!same)
    plan.warnings.push_back(
        fmt::format("{}: its OME-XML says {}, its tags {} bits read as {}; the tags are believed",
                    start.file.path(), image.type, page.stored_bits, type));
}

// The planes that make up the volume, by their place in the image's order.
OmeWanted wanted_planes(const OmeImage& image, const StackStart& start, const InputSpec& spec,
                        StackPlan& plan) {
  OmeSizes sizes{.z = image.z, .c = image.c / start.page.channels, .t = image.t};
  if (static_cast<double>(sizes.z) * static_cast<double>(sizes.c) * static_cast<double>(sizes.t) >
      most_planes)
    throw FormatError(fmt::format("{}: its OME-XML announces {} x {} x {} planes",
                                  start.file.path(), sizes.z, sizes.c, sizes.t));
  const std::optional<OmeStrides> strides = ome_strides(image.order, sizes);
  if (!strides)
    throw FormatError(
        fmt::format("{}: its OME-XML has the DimensionOrder '{}'; expected XYZCT, or "
                    "its like",
                    start.file.path(), image.order));
  const std::int64_t channel = choose_channel(start, sizes.c, image.channels, spec, plan);
  OmeWanted wanted{.total = sizes.z * sizes.c * sizes.t};
  wanted.first = channel * strides->c;
  if (image.z == 1 && image.t > 1 && !spec.select.time) {
    plan.warnings.push_back(fmt::format(
        "{}: its {} times are taken for slices; input.time (--time) takes one of them for itself",
        spec.path, image.t));
    wanted.step = strides->t;
    wanted.count = image.t;
    return wanted;
  }
  const auto nameless = [](std::int64_t) { return std::string(); };
  wanted.first += strides->t * choose_one({Selector::time, image.t, nameless}, spec, plan);
  wanted.step = strides->z;
  wanted.count = image.z;
  return wanted;
}

}  // namespace

void plan_ome(const std::string& xml, const InputSpec& spec, StackPlan& plan) {
  const bool from_companion = plan.files.empty();
  const std::filesystem::path own =
      from_companion ? std::filesystem::path(spec.path) : plan.files.front();
  std::filesystem::path metadata_path = own;
  const OmeMetadata metadata = whole_metadata(xml, spec, metadata_path);
  const OmeImage& image = choose_image(metadata, spec, plan);

  OmeFiles files({.metadata = metadata_path,
                  .own = from_companion ? std::filesystem::path() : own,
                  .own_uuid = metadata.uuid,
                  .follow = spec.follow});
  std::vector<OmePages> pages = image.pages;
  if (pages.empty()) pages.push_back({.page = 0, .count = image.z * image.c * image.t});
  files.allow_renamed(metadata.images, plan.warnings);
  const std::size_t first_file = files.find(pages.front());
  ImageFile first(files.path(first_file));
  const auto index = static_cast<std::size_t>(pages.front().page.value_or(0));
  if (index >= first.page_count())
    throw FormatError(fmt::format("{}: has {} pages, but the OME-XML names page {}", first.path(),
                                  first.page_count(), index + 1));
  const StackStart start{first, first.page(index), index};
  check_page(start, image, plan);
  choose_level(start, spec, plan);
  const OmeWanted wanted = wanted_planes(image, start, spec, plan);
  plan.paged = true;
  plan.planes = find_ome_planes(pages, image, wanted, files);
  plan.files = files.paths();
  plan.calibration = ome_calibration(image, metadata_path.string());
}

}  // namespace voxweld
