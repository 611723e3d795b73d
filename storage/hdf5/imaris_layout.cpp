#include <fmt/format.h>

#include <cmath>

#include "storage/hdf5/hdf5_attributes.h"
#include "storage/hdf5/hdf5_layouts.h"
#include "storage/support/error.h"
#include "storage/volumes/axes.h"

namespace voxweld {
namespace {

constexpr std::int64_t most_numbered = 100'000;

// How many groups "NAME 0", "NAME 1" ... there are.
std::int64_t count_numbered(hid_t group, const std::string& name) {
  std::int64_t count = 0;
  while (count < most_numbered &&
         H5Lexists(group, fmt::format("{} {}", name, count).c_str(), H5P_DEFAULT) > 0)
    ++count;
  return count;
}

Hdf5Handle open_numbered(const Hdf5File& file, const Hdf5Handle& group, const std::string& name,
                         std::int64_t number) {
  Hdf5Handle opened = file.open_group(group.get(), fmt::format("{} {}", name, number));
  if (opened) return opened;
  throw FormatError(fmt::format("{}: not laid out as an Imaris file: a group '{} {}' is missing",
                                file.path(), name, number));
}

std::vector<std::string> channel_names(const Hdf5File& file, std::int64_t count) {
  std::vector<std::string> names;
  for (std::int64_t i = 0; i < std::min<std::int64_t>(count, 256); ++i) {
    const Hdf5Handle group = file.open_group(file.id(), fmt::format("/DataSetInfo/Channel {}", i));
    names.push_back(group ? text_attribute(group.get(), "Name").value_or("") : "");
  }
  return names;
}

// The part of the dataset that is image.
void crop_to_image(const Hdf5Handle& channel, const std::string& where, FoundVolume& found) {
  Index3& size = found.info.geometry.size;
  for (int a = 0; a < 3; ++a) {
    const std::string name = std::string("ImageSize") + "XYZ"[a];
    const auto said = number_attribute(channel.get(), name);
    if (!said) {
      found.info.warnings.push_back(where + ": " + name +
                                    " is missing: the dataset may be filled up beyond the image");
      continue;
    }
    if (!(*said >= 1) || *said != std::floor(*said) || *said > static_cast<double>(size[a]))
      throw FormatError(fmt::format("{}: {} is {}: expected a whole number from 1 to {}", where,
                                    name, *said, size[a]));
    size[a] = static_cast<std::int64_t>(*said);
  }
}

void read_extent(const Hdf5File& file, VolumeInfo& info) {
  const Hdf5Handle image = file.open_group(file.id(), "/DataSetInfo/Image");
  const std::string where = file.path() + ": /DataSetInfo/Image";
  std::array<Vec3, 3> steps;
  Vec3 origin;
  for (int a = 0; a < 3; ++a) {
    const auto lo =
        image ? number_attribute(image.get(), fmt::format("ExtMin{}", a)) : std::nullopt;
    const auto hi =
        image ? number_attribute(image.get(), fmt::format("ExtMax{}", a)) : std::nullopt;
    if (!lo || !hi) {
      info.warnings.push_back(where +
                              ": says no ExtMin and ExtMax; a spacing of 1 x 1 x 1 is "
                              "assumed, set it in the config");
      return;
    }
    const double step = (*hi - *lo) / static_cast<double>(info.geometry.size[a]);
    steps[static_cast<std::size_t>(a)][a] = step;
    origin[a] = *lo + step / 2;
  }
  set_axes(info, steps, where);
  info.geometry.origin = origin;
  info.geometry.unit = canonical_unit(text_attribute(image.get(), "Unit").value_or(""));
}

}  // namespace

std::optional<FoundVolume> imaris_volume(const Hdf5File& file, const InputSpec& spec) {
  const Hdf5Handle levels = file.open_group(file.id(), "/DataSet");
  if (!levels || H5Lexists(levels.get(), "ResolutionLevel 0", H5P_DEFAULT) <= 0) return {};
  if (!spec.select.dataset.empty())
    throw InputError(fmt::format(
        "{}: an Imaris file: choose by input.level, input.channel and input.time (--level, "
        "--channel, --time), and remove input.dataset",
        file.path()));
  FoundVolume found;
  VolumeInfo& info = found.info;
  const auto choose = [&](Selector selector, std::optional<std::int64_t> wanted, std::int64_t count,
                          std::vector<std::string> texts = {}) {
    return choose_index({selector, wanted, std::max<std::int64_t>(1, count), std::move(texts),
                         selector == Selector::level},
                        spec.survey, file.path(), info);
  };
  const std::int64_t level =
      choose(Selector::level, spec.select.level, count_numbered(levels.get(), "ResolutionLevel"));
  const Hdf5Handle times = open_numbered(file, levels, "ResolutionLevel", level);
  const std::int64_t time =
      choose(Selector::time, spec.select.time, count_numbered(times.get(), "TimePoint"));
  const Hdf5Handle channels = open_numbered(file, times, "TimePoint", time);
  const std::int64_t channel_count = count_numbered(channels.get(), "Channel");
  const std::int64_t number = choose(Selector::channel, spec.select.channel, channel_count,
                                     channel_names(file, channel_count));
  const Hdf5Handle channel = open_numbered(file, channels, "Channel", number);
  const std::string path =
      fmt::format("/DataSet/ResolutionLevel {}/TimePoint {}/Channel {}/Data", level, time, number);
  found.dataset = file.open_dataset(channel.get(), "Data");
  if (!found.dataset) fail_hdf5(file.where("dataset", path), "cannot be opened");
  found.facts = dataset_facts(file, found.dataset.get(), path);
  const std::string where = file.where("dataset", path);
  if (found.facts.dims.size() != 3)
    throw FormatError(
        fmt::format("{}: has {} dimensions: expected three", where, found.facts.dims.size()));
  found.place = {{2, 1, 0}, {0, 0, 0}};
  info.geometry.size = size_of(found.facts, found.place);
  crop_to_image(channel, where, found);
  read_extent(file, info);
  return found;
}

}  // namespace voxweld
