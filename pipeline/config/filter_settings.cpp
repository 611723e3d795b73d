#include "pipeline/config/filter_settings.h"

#include <utility>

#include "pipeline/config/item_rows.h"
#include "pipeline/config/label_list.h"
#include "pipeline/config/setting_rows.h"

namespace voxweld {
namespace {

using item_rows::choice;
using item_rows::member;
using item_rows::open;
using item_rows::required;
using FilterBinding = binding::Binding<FilterConfig>;

FilterSetting filter_row(item_rows::ItemWords words, const FilterBinding& bound,
                         std::vector<FilterType> types = {}) {
  return item_rows::row(words, bound, std::move(types));
}

// Letters in the order of the axes, whatever the order they are written in.
FilterBinding flipped_axes() {
  return binding::bound<FilterConfig>(
      AxesRule{}, item_rows::place(&FilterConfig::flipped),
      [](const ConfigValue& value, std::array<bool, 3>& out) {
        out = {};
        for (const char letter : *value.text()) out[static_cast<std::size_t>(letter - 'x')] = true;
      },
      [](const std::array<bool, 3>& in) {
        std::string letters;
        for (std::size_t axis = 0; axis < 3; ++axis)
          if (in[axis]) letters += "xyz"[axis];
        return ConfigValue{letters};
      });
}

FilterBinding axis_order() {
  return binding::bound<FilterConfig>(
      ChoiceRule{{"xzy", "yxz", "yzx", "zxy", "zyx"}}, item_rows::place(&FilterConfig::order),
      [](const ConfigValue& value, std::array<int, 3>& out) {
        for (std::size_t axis = 0; axis < 3; ++axis) out[axis] = (*value.text())[axis] - 'x';
      },
      [](const std::array<int, 3>& in) {
        std::string letters;
        for (const int axis : in) letters += "xyz"[axis];
        return ConfigValue{letters};
      });
}

FilterBinding mask_values() {
  return binding::bound<FilterConfig>(
      LabelListRule{}, item_rows::place(&FilterConfig::values),
      [](const ConfigValue& value, auto& out) { out = label_ranges_of(*value.list()); },
      [](const auto& in) {
        return in.empty() ? std::nullopt : binding::Written(ConfigValue{label_items(in)});
      });
}

// 0 where there is none.
FilterBinding voxels(std::int64_t FilterConfig::*count) {
  return binding::bound<FilterConfig>(
      IntegerRule{1, rows::no_limit}, item_rows::place(count),
      [](const ConfigValue& value, std::int64_t& out) { out = *value.integer(); },
      [](std::int64_t in) { return in == 0 ? std::nullopt : binding::Written(ConfigValue{in}); });
}

// Of the result's samples.
FilterSetting sample_type() {
  using enum FilterType;
  return open("as it was",
              filter_row({"sample_type",
                          "Type of the result's samples. Of integers the result is rounded to the "
                          "nearest and kept within the type. downsample takes it with method = "
                          "\"mean\" only.",
                          "\"float32\""},
                         member(&FilterConfig::sample_type, binding::sample_types()),
                         {window, gaussian, mean, downsample}));
}

std::vector<FilterSetting> smoothing_settings() {
  using enum FilterType;
  return {
      required(filter_row({"clip",
                           "Two real values: a sample below the first becomes that one, a sample "
                           "above the second becomes that.",
                           "[-1000.0, 2000.0]"},
                          member(&FilterConfig::clip, NumberPairRule{}), {window})),
      open("nowhere else",
           filter_row({"scale",
                       "Where the two values of clip go, and what is between them "
                       "on a straight line. With the greater first, dark and light "
                       "change places.",
                       "[0.0, 255.0]"},
                      member(&FilterConfig::scale, NumberPairRule{NumberPairRule::Of::apart}),
                      {window})),
      required(filter_row({"sigma",
                           "Standard deviation of the Gaussian, in samples: of all axes or of "
                           "each. 0: not along that axis.",
                           "[1.0, 1.0, 0.5]"},
                          member(&FilterConfig::sigma, PerAxisRule{0, 50, false}), {gaussian})),
      filter_row({"radius",
                  "The box around a sample has 2 * radius + 1 samples a side. 0: not along that "
                  "axis. A median's is at most 10.",
                  "[1, 1, 0]"},
                 member(&FilterConfig::radius, PerAxisRule{0, 50, true}), {mean, median}),
      filter_row({"factor",
                  "How many samples along each axis become one. What is left over at the upper "
                  "ends is dropped.",
                  "[2, 2, 1]"},
                 member(&FilterConfig::factor, PerAxisRule{1, 64, true}), {downsample}),
      filter_row({"method",
                  "What becomes of them: their mean, the greatest, or \"mode\", the value most of "
                  "them have, which is for labels.",
                  "\"mean\""},
                 choice(&FilterConfig::method, {"mean", "max", "mode"}), {downsample})};
}

std::vector<FilterSetting> other_settings() {
  using enum FilterType;
  return {
      required(filter_row({"axes", "The axes to turn around.", "\"z\""}, flipped_axes(), {flip})),
      required(filter_row({"order",
                           "Which axes of the input the axes x, y and z of the result are: with "
                           "\"zyx\" x and z change places.",
                           "\"zyx\""},
                          axis_order(), {permute})),
      required(
          filter_row({"path",
                      "A volume of integers that has the size the samples have here, in a file "
                      "or folder of any format that is read. Samples correspond by their "
                      "index.",
                      "\"mask.nrrd\""},
                     member(&FilterConfig::path, PathRule{}), {mask})),
      open("all but 0",
           filter_row({"values", "Where the mask has one of these, samples stay as they are.",
                       "[1, \"5-9\"]"},
                      mask_values(), {mask})),
      open("of a mask: required, but 0 where labels are meshed; of keep: the least sample where "
           "inside is above, else the greatest",
           filter_row({"outside",
                       "The real value that samples get outside the mask, or in pieces that are "
                       "not kept.",
                       "0.0"},
                      member(&FilterConfig::outside, NumberRule{}), {mask, keep})),
      open("the largest piece alone",
           filter_row(
               {"min_voxels", "Pieces of the material with fewer samples are taken away.", "1000"},
               voxels(&FilterConfig::min_voxels), {keep})),
      required(
          filter_row({"max_voxels",
                      "Holes in the material of at most so many samples are filled. A hole does "
                      "not reach the volume's border.",
                      "1000"},
                     voxels(&FilterConfig::max_voxels), {fill})),
      open("the greatest sample where inside is above, else the least",
           filter_row({"inside", "The real value that the samples of filled holes get.", "255.0"},
                      member(&FilterConfig::inside, NumberRule{}), {fill}))};
}

std::vector<FilterSetting> filter_settings(const std::vector<std::string>& types) {
  std::vector<FilterSetting> all;
  all.push_back(required(filter_row(
      {"type",
       "What it does. \"window\" clips and scales values; \"gaussian\", \"mean\" and \"median\" "
       "smooth; \"downsample\" makes one sample of several; \"flip\" and \"permute\" turn the "
       "volume; \"mask\" blots out what another volume says; \"keep\" takes small pieces of the "
       "material away and \"fill\" fills small holes in it.",
       ""},
      choice(&FilterConfig::type, types))));
  for (auto make : {smoothing_settings, other_settings})
    for (FilterSetting& setting : make()) all.push_back(std::move(setting));
  all.push_back(sample_type());
  return all;
}

FilterTable make_filter_table() {
  const std::vector<std::string> types = {"window", "gaussian", "mean", "median", "downsample",
                                          "flip",   "permute",  "mask", "keep",   "fill"};
  return {.name = std::string(filter_table),
          .one = "a filter",
          .kind_key = "type",
          .noun = " filter",
          .description =
              "What happens to the samples between the file and the surface, one step to each "
              "[[filter]], in the order of the file. input.crop comes before all filters, [[edit]] "
              "after them. Values are real ones, lengths are in samples of the volume as the "
              "filter finds it. Labels take only filters that make no new ones: downsample with "
              "method = \"mode\", flip, permute and mask.",
          .stage = Stage::ingest,
          .reruns = "ingest",
          .kind = &FilterConfig::type,
          .kind_names = types,
          .settings = filter_settings(types)};
}

}  // namespace

const FilterTable& filter_items() {
  static const FilterTable table = make_filter_table();
  return table;
}

}  // namespace voxweld
