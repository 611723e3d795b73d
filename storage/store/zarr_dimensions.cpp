// Which dimensions of an array are z, y and x, and which index of the others is read.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "storage/store/zarr_fields.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

constexpr int other_axis = -1, channel_axis = -2, time_axis = -3, unknown_axis = -4;

int axis_of_name(const std::string& name) {
  static constexpr std::pair<const char*, int> names[] = {{"x", 0},
                                                          {"y", 1},
                                                          {"z", 2},
                                                          {"c", channel_axis},
                                                          {"ch", channel_axis},
                                                          {"channel", channel_axis},
                                                          {"channels", channel_axis},
                                                          {"t", time_axis},
                                                          {"time", time_axis},
                                                          {"times", time_axis},
                                                          {"frame", time_axis}};
  const std::string lowered = lower(name);
  for (const auto& [known, axis] : names)
    if (lowered == known) return axis;
  return unknown_axis;
}

// Of dimensions that nobody names: the last three, or less, are z, y, x; of what is 1 long nothing
// need be known.
std::vector<int> axes_by_place(const JsonField& shape, const Extents& extents) {
  std::vector<int> axes(extents.size(), other_axis);
  std::vector<std::size_t> kept;
  for (std::size_t d = 0; d < extents.size(); ++d) kept.push_back(d);
  while (kept.size() > 3 && extents[kept.front()] == 1) kept.erase(kept.begin());
  while (kept.size() > 3 && extents[kept.back()] == 1) kept.pop_back();
  if (kept.size() > 3)
    shape.refuse(fmt::format(
        "{} dimensions of {} samples, and nothing says which of them are z, y and x: name them "
        "(axes of OME-Zarr, dimension_names, _ARRAY_DIMENSIONS), or extract one volume first",
        extents.size(), fmt::join(extents, " x ")));
  for (std::size_t i = 0; i < kept.size(); ++i)
    axes[kept[i]] = static_cast<int>(kept.size() - 1 - i);
  return axes;
}

// Empty where the names tell nothing.
std::vector<int> axes_by_name(const JsonField& shape, const Extents& extents,
                              const ArrayContext& context) {
  std::vector<int> axes;
  if (context.axes.size() != extents.size()) return {};
  bool x = false, y = false, z = false, doubled = false, others = false;
  for (std::size_t d = 0; d < extents.size(); ++d) {
    const std::string type = d < context.types.size() ? context.types[d] : "";
    int axis = axis_of_name(context.axes[d]);
    if (axis < 0 && type == "channel") axis = channel_axis;
    if (axis < 0 && type == "time") axis = time_axis;
    for (bool* seen : {&x, &y, &z})
      if (axis == (seen == &x ? 0 : seen == &y ? 1 : 2)) {
        doubled = doubled || *seen;
        *seen = true;
      }
    others = others || axis == channel_axis || axis == time_axis;
    axes.push_back(axis == unknown_axis ? other_axis : axis);
  }
  if (x && y && !doubled) return axes;
  if (others)
    shape.refuse(fmt::format("the dimensions are {}, which makes no volume: x and y expected",
                             fmt::join(context.axes, ", ")));
  return {};
}

// One of the channels or times.
struct FixedDimension {
  Selector selector;
  std::int64_t size;
  std::optional<std::int64_t> wanted;
  const std::vector<std::string>* labels;
};

std::string listed(const FixedDimension& dimension) {
  constexpr std::int64_t most = 16;
  std::string text;
  for (std::int64_t i = 0; i < std::min(dimension.size, most); ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : ", ", i);
    const auto at = static_cast<std::size_t>(i);
    if (at < dimension.labels->size() && !(*dimension.labels)[at].empty())
      text += fmt::format(" ({})", (*dimension.labels)[at]);
  }
  return dimension.size > most ? fmt::format("{} ... {}", text, dimension.size - 1) : text;
}

std::int64_t chosen_index(const FixedDimension& dimension, const ArrayContext& context,
                          ZarrArray& array) {
  constexpr std::int64_t most_listed = 256;
  const char* name = selector_name(dimension.selector);
  const std::string file = (array.path / array.metadata).string();
  if (dimension.wanted && (*dimension.wanted < 0 || *dimension.wanted >= dimension.size))
    throw InputError(fmt::format("{}: input.{} (--{}) is {}, and there are {}: {}", file, name,
                                 name, *dimension.wanted, dimension.size, listed(dimension)));
  if (dimension.size > 1 && !dimension.wanted && !context.survey)
    throw InputError(
        fmt::format("{}: holds {} {}s, of which one is read: set input.{} or --{} to "
                    "one of {}",
                    file, dimension.size, name, name, name, listed(dimension)));
  const std::int64_t index = dimension.wanted.value_or(0);
  if (dimension.size == 1) return index;
  if (!dimension.wanted)
    array.warnings.push_back(
        fmt::format("{}: of {} {}s the first is shown: set input.{} or --{} for another", file,
                    dimension.size, name, name, name));
  for (std::int64_t i = 0; i < std::min(dimension.size, most_listed); ++i) {
    const auto at = static_cast<std::size_t>(i);
    array.choices.push_back({name, std::to_string(i),
                             at < dimension.labels->size() ? (*dimension.labels)[at] : "",
                             i == index});
  }
  return index;
}

void refuse_choice(const ZarrArray& array, const char* name) {
  throw InputError(
      fmt::format("{}: input.{} (--{}) is set, and the array has one {} only; remove it",
                  (array.path / array.metadata).string(), name, name, name));
}

}  // namespace

void settle_dimensions(const JsonField& shape, const ArrayContext& context, ZarrArray& array) {
  const std::size_t rank = shape.elements().size();
  if (rank < 2)
    shape.refuse(fmt::format("{} dimensions are not supported, 2 or more expected", rank));
  if (rank > 16) shape.refuse(fmt::format("{} dimensions are not supported", rank));
  const Extents extents = zarr_extents(shape, rank);
  std::vector<int> axes = axes_by_name(shape, extents, context);
  if (axes.empty()) axes = axes_by_place(shape, extents);
  array.at.assign(rank, 0);
  bool channels = false, times = false;
  for (std::size_t d = 0; d < rank; ++d) {
    const bool channel = axes[d] == channel_axis, time = axes[d] == time_axis;
    static const std::vector<std::string> none;
    if ((channel && channels) || (time && times))
      shape.refuse(
          fmt::format("the dimensions are {}: two of a kind", fmt::join(context.axes, ", ")));
    if (channel || time)
      array.at[d] = chosen_index({channel ? Selector::channel : Selector::time, extents[d],
                                  channel ? context.select.channel : context.select.time,
                                  channel ? &context.channels : &none},
                                 context, array);
    else if (axes[d] < 0 && extents[d] > 1)
      shape.refuse(
          fmt::format("the dimensions are {}, of {} samples: of \"{}\" no index can be "
                      "chosen; extract one volume first",
                      fmt::join(context.axes, ", "), fmt::join(extents, " x "), context.axes[d]));
    channels = channels || channel;
    times = times || time;
    if (axes[d] < 0) axes[d] = -1;
  }
  if (!channels && context.select.channel.value_or(0) != 0) refuse_choice(array, "channel");
  if (!times && context.select.time.value_or(0) != 0) refuse_choice(array, "time");
  array.axes = std::move(axes);
  array.size = array.axes_of(extents);
}

}  // namespace voxweld
