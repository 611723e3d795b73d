#include "storage/volumes/array_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t most_listed = 100;

std::string listed_arrays(const std::vector<FileArray>& arrays) {
  std::string text;
  for (std::size_t i = 0; i < std::min(arrays.size(), most_listed); ++i)
    text += fmt::format(
        "{}'{}' ({}{})", i == 0 ? "" : ", ", arrays[i].selector, arrays[i].type_name,
        arrays[i].components == 1 ? std::string()
                                  : fmt::format(", {} components", arrays[i].components));
  if (arrays.size() > most_listed) text += ", ...";
  return text;
}

std::size_t settle_array(const std::vector<FileArray>& arrays, std::optional<std::size_t> preferred,
                         const InputSpec& spec, VolumeInfo& info) {
  if (spec.select.has(Selector::dataset)) {
    const auto found = std::ranges::find(arrays, spec.select.dataset, &FileArray::selector);
    if (found != arrays.end()) return static_cast<std::size_t>(found - arrays.begin());
    throw InputError(
        fmt::format("{}: no array '{}': there are {}; correct input.dataset or --dataset",
                    spec.path, spec.select.dataset, listed_arrays(arrays)));
  }
  if (preferred) return *preferred;
  if (arrays.size() == 1) return 0;  // perhaps to be refused for what it is
  if (const auto only = only_readable(arrays)) return *only;
  if (!spec.survey)
    throw InputError(
        fmt::format("{}: the file has {} arrays: {}; choose one: set input.dataset or --dataset",
                    spec.path, arrays.size(), listed_arrays(arrays)));
  info.warnings.push_back(
      fmt::format("{}: the first of {} arrays is shown: choose one: set input.dataset or --dataset",
                  spec.path, arrays.size()));
  return 0;
}

}  // namespace

std::optional<std::size_t> only_readable(const std::vector<FileArray>& arrays) {
  std::optional<std::size_t> only;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (arrays[i].components != 1 || !arrays[i].type) continue;
    if (only) return {};
    only = i;
  }
  return only;
}

std::size_t choose_array(const std::vector<FileArray>& arrays, std::optional<std::size_t> preferred,
                         const InputSpec& spec, VolumeInfo& info) {
  if (arrays.empty())
    throw FormatError(spec.path + ": no array of samples: there is nothing to read");
  const std::size_t chosen = settle_array(arrays, preferred, spec, info);
  if (arrays.size() > 1)
    for (std::size_t i = 0; i < arrays.size(); ++i)
      info.choices.push_back(
          {.selector = selector_name(Selector::dataset),
           .value = arrays[i].selector,
           .text = fmt::format("{}, {} component{}{}{}", arrays[i].type_name, arrays[i].components,
                               arrays[i].components == 1 ? "" : "s",
                               arrays[i].place.empty() ? "" : ", ", arrays[i].place),
           .chosen = i == chosen});
  const FileArray& array = arrays[chosen];
  if (array.components != 1)
    throw FormatError(fmt::format(
        "{}: array '{}' has {} values a sample: vectors and colours are not supported, extract one "
        "component first{}",
        spec.path, array.selector, array.components,
        arrays.size() > 1 ? ", or choose another array with input.dataset or --dataset" : ""));
  if (!array.type)
    throw FormatError(
        fmt::format("{}: array '{}' has values of type {}: expected integers of 8 to 64 bits or "
                    "floats of 32 or 64: convert the file first",
                    spec.path, array.selector, array.type_name));
  return chosen;
}

}  // namespace voxweld
