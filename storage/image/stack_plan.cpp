#include "storage/image/stack_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "storage/image/slice_files.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

constexpr std::int64_t listed_in_messages = 16, listed_in_all = 1000;

std::optional<std::int64_t> asked_for(const InputSelection& select, Selector selector) {
  if (selector == Selector::level) return select.level;
  if (selector == Selector::channel) return select.channel;
  return selector == Selector::time ? select.time : std::nullopt;
}

std::string list_of(const StackChoice& of) {
  std::string list;
  for (std::int64_t i = 0; i < std::min(of.count, listed_in_messages); ++i) {
    const std::string text = of.text(i);
    list += fmt::format("{}{}{}", i == 0 ? "" : ", ", i, text.empty() ? "" : " (" + text + ")");
  }
  return list + (of.count > listed_in_messages ? fmt::format(" ... {}", of.count - 1) : "");
}

void note_choices(const StackChoice& of, std::int64_t chosen, StackPlan& plan) {
  for (std::int64_t i = 0; i < of.count && of.count > 1; ++i)
    if (i < listed_in_all || i == chosen)
      plan.choices.push_back(
          {selector_name(of.selector), std::to_string(i), of.text(i), i == chosen});
}

void refuse_palette(const ImageFile& file, const ImagePage& page) {
  if (!page.palette || page.format == "tiff") return;
  throw FormatError(
      fmt::format("{}: a palette (indexed colour) image, whose indices are not grey values; "
                  "expected one grey channel: convert the slices to grey (in ImageJ: Image > Type "
                  "> 8-bit)",
                  file.path()));
}

void refuse_dataset(const InputSpec& spec) {
  if (!spec.select.dataset.empty())
    throw InputError(fmt::format(
        "{}: input.dataset (--dataset) is '{}', but only OME-TIFF files hold several named images; "
        "remove it",
        spec.path, spec.select.dataset));
}

void plan_plain(StackStart& start, const InputSpec& spec, StackPlan& plan) {
  plan.paged = plan.files.size() == 1 && start.file.page_count() > 1;
  const std::size_t slices = plan.paged ? start.file.page_count() : plan.files.size();
  for (std::size_t z = 0; z < slices; ++z)
    plan.planes.push_back(plan.paged ? StackPlane{0, z} : StackPlane{z, 0});
  choose_channel(start, 1, {}, spec, plan);
  choose_one({Selector::time, 1, [](std::int64_t) { return std::string(); }}, spec, plan);
  plan.calibration =
      read_calibration(start.page, {start.file.path(), plan.files.size() == 1 ? slices : 1});
}

bool holds_ome(const ImagePage& page) {
  return page.description.substr(0, 4096).find("<OME") != std::string::npos;
}

}  // namespace

std::int64_t choose_one(const StackChoice& of, const InputSpec& spec, StackPlan& plan) {
  const std::string name = selector_name(of.selector);
  const std::string there = fmt::format("{}: has {} {}{}", spec.path, of.count, name,
                                        of.count == 1 ? "" : "s: " + list_of(of));
  std::optional<std::int64_t> chosen = asked_for(spec.select, of.selector);
  if (chosen && (*chosen < 0 || *chosen >= of.count))
    throw InputError(fmt::format("{}; input.{} (--{}) is {}", there, name, name, *chosen));
  if (!chosen && of.count > 1 && !spec.survey)
    throw InputError(
        fmt::format("{}; set input.{} or --{} to the one to be meshed", there, name, name));
  if (!chosen && of.count > 1)
    plan.warnings.push_back(
        fmt::format("{}; shown is {} 0: input.{} (--{}) chooses another", there, name, name, name));
  note_choices(of, chosen.value_or(0), plan);
  return chosen.value_or(0);
}

void choose_level(const StackStart& start, const InputSpec& spec, StackPlan& plan) {
  const StackChoice levels{
      Selector::level, start.page.levels, [&](std::int64_t level) {
        const ImagePage page =
            level == 0
                ? start.page
                : ImageFile(start.file.file().path, static_cast<int>(level)).page(start.index);
        return fmt::format("{} x {}", page.width, page.height);
      }};
  InputSpec finest = spec;
  finest.select.level = spec.select.level.value_or(0);
  plan.level = static_cast<int>(choose_one(levels, finest, plan));
}

std::int64_t choose_channel(const StackStart& start, std::int64_t planes,
                            const std::vector<std::string>& names, const InputSpec& spec,
                            StackPlan& plan) {
  const std::int64_t samples = start.page.channels;
  const auto name_in = [](const std::vector<std::string>& all, std::int64_t i) {
    return static_cast<std::size_t>(i) < all.size() ? all[static_cast<std::size_t>(i)] : "";
  };
  const StackChoice channels{
      Selector::channel, planes * samples, [&](std::int64_t i) {
        const std::string plane = name_in(names, i / samples);
        const std::string sample =
            samples == 1 ? "" : name_in(start.page.channel_names, i % samples);
        return plane + (plane.empty() || sample.empty() ? "" : ", ") + sample;
      }};
  const std::int64_t chosen = choose_one(channels, spec, plan);
  if (samples > 1) plan.channel = static_cast<int>(chosen % samples);
  return chosen / samples;
}

StackPlan plan_stack(const InputSpec& spec) {
  StackPlan plan;
  if (name_extension(spec.path) == ".ome" && std::filesystem::is_regular_file(spec.path)) {
    plan_ome(read_text_file(spec.path), spec, plan);
    return plan;
  }
  SliceFiles found = find_slices(spec.path);
  SliceFiles ordered = order_slices(std::move(found.paths));
  plan.warnings = std::move(found.warnings);
  plan.warnings.insert(plan.warnings.end(), ordered.warnings.begin(), ordered.warnings.end());
  plan.files = std::move(ordered.paths);

  ImageFile first(plan.files.front());
  StackStart start{first, first.page(0)};
  refuse_palette(first, start.page);
  const bool alone = plan.files.size() == 1;
  if (alone && holds_ome(start.page)) {
    plan_ome(start.page.description, spec, plan);
    return plan;
  }
  refuse_dataset(spec);
  choose_level(start, spec, plan);
  if (alone && start.page.description.starts_with("ImageJ="))
    plan_imagej(start, spec, plan);
  else
    plan_plain(start, spec, plan);
  return plan;
}

}  // namespace voxweld
