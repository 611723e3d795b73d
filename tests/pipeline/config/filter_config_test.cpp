// Filters that are right: how they are read and written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "tests/pipeline/config/config_texts.h"
#include "tests/pipeline/config/filter_texts.h"

namespace voxweld {
namespace {

using testing::filter_sample;
using testing::least_config;
using testing::parse;

std::vector<FilterConfig> filters(const std::string& text) {
  return parse(least_config(text)).filters;
}

TEST(FilterConfig, EveryTypeAndKeyIsRead) {
  const auto found = filters(R"(
[[filter]]
type = "window"
clip = [-1000, 2000.5]
[[filter]]
type = "window"
clip = [0, 1]
scale = [255, 0]
sample_type = "uint8"
[[filter]]
type = "gaussian"
sigma = 1.5
[[filter]]
type = "gaussian"
sigma = [1, 0, 0.5]
sample_type = "float64"
[[filter]]
type = "mean"
[[filter]]
type = "mean"
radius = 50
sample_type = "float32"
[[filter]]
type = "median"
radius = [10, 0, 1]
[[filter]]
type = "downsample"
[[filter]]
type = "downsample"
factor = [1, 64, 1]
method = "max"
[[filter]]
type = "downsample"
factor = 3
method = "mean"
sample_type = "int16"
[[filter]]
type = "flip"
axes = "zx"
[[filter]]
type = "permute"
order = "yzx"
[[filter]]
type = "mask"
path = "masks/../mask.nrrd"
outside = -5
[[filter]]
type = "mask"
path = "/elsewhere/mask.nii"
values = ["5-9", 1, 2]
outside = 0.5
[[filter]]
type = "keep"
[[filter]]
type = "keep"
min_voxels = 12
outside = 0
[[filter]]
type = "fill"
max_voxels = 9223372036854775807
[[filter]]
type = "fill"
max_voxels = 1
inside = 255
)");
  using enum FilterType;
  using Method = FilterConfig::Method;
  const std::vector<FilterConfig> expected = {
      {.clip = {-1000, 2000.5}},
      {.clip = {0, 1}, .scale = {{255, 0}}, .sample_type = SampleType::u8},
      {.type = gaussian, .sigma = {1.5, 1.5, 1.5}},
      {.type = gaussian, .sample_type = SampleType::f64, .sigma = {1, 0, 0.5}},
      {.type = mean},
      {.type = mean, .sample_type = SampleType::f32, .radius = {50, 50, 50}},
      {.type = median, .radius = {10, 0, 1}},
      {.type = downsample},
      {.type = downsample, .factor = {1, 64, 1}, .method = Method::max},
      {.type = downsample, .sample_type = SampleType::i16, .factor = {3, 3, 3}},
      {.type = flip, .flipped = {true, false, true}},
      {.type = permute, .order = {1, 2, 0}},
      {.type = mask, .path = "/data/mask.nrrd", .outside = -5},
      {.type = mask, .path = "/elsewhere/mask.nii", .values = {{1, 2}, {5, 9}}, .outside = 0.5},
      {.type = keep},
      {.type = keep, .outside = 0, .min_voxels = 12},
      {.type = fill, .max_voxels = std::numeric_limits<std::int64_t>::max()},
      {.type = fill, .inside = 255, .max_voxels = 1}};
  EXPECT_EQ(found, expected);
}

TEST(FilterConfig, EverySampleTypeIsTaken) {
  for (int i = 0; i <= static_cast<int>(SampleType::f64); ++i) {
    const auto type = static_cast<SampleType>(i);
    const std::string name = toml_string(sample_type_name(type));
    EXPECT_EQ(filters(filter_sample(FilterType::mean, {{"sample_type", name}}))[0].sample_type,
              type);
  }
}

TEST(FilterConfig, OtherFormsOfTomlSayTheSame) {
  const auto expected = filters(
      "[[filter]]\ntype = \"mean\"\nradius = [2, 2, 2]\n"
      "[[filter]]\ntype = \"flip\"\naxes = \"xyz\"\n");
  EXPECT_EQ(
      filters("filter = [{type = \"mean\", radius = 2}, {axes = \"zyx\", type = \"flip\"}]\n"),
      expected);
  EXPECT_TRUE(filters("filter = []\n").empty());
}

TEST(FilterConfig, CanonicalTomlHasThemBeforeEdits) {
  const Config config =
      parse(least_config("[[edit]]\nshape = \"sphere\"\ncenter = [1, 2, 3]\nradius = 1\n"
                         "[[filter]]\ntype = \"gaussian\"\nsigma = 1\n"
                         "[[filter]]\naxes = \"zx\"\ntype = \"flip\"\n"
                         "[[filter]]\ntype = \"mask\"\noutside = 0\nvalues = [3, \"1-2\"]\n"
                         "path = \"mask.nrrd\"\n"
                         "[[filter]]\ntype = \"keep\"\n"));
  const std::string text = canonical_toml(config);
  const auto begin = text.find("\n[[filter]]");
  EXPECT_EQ(text.substr(begin, text.find("\n[[edit]]") - begin), R"(
[[filter]]
type = "gaussian"
sigma = [1.0, 1.0, 1.0]

[[filter]]
type = "flip"
axes = "xz"

[[filter]]
type = "mask"
path = "/data/mask.nrrd"
values = ["1-3"]
outside = 0.0

[[filter]]
type = "keep"
)");
  EXPECT_EQ(parse_config(text, "/elsewhere/other.toml"), config);
  EXPECT_EQ(canonical_toml(parse(least_config())).find("filter"), std::string::npos);
}

TEST(FilterConfig, OutsideAMaskIsNoLabel) {
  const std::string mask = "[[filter]]\ntype = \"mask\"\npath = \"mask.nrrd\"\n";
  const auto outside = [](const std::string& text) { return parse(text).filters.at(0).outside; };
  EXPECT_EQ(outside(least_config("labels.mode = \"each\"\n" + mask)), 0);
  EXPECT_EQ(outside("input.path = \"a\"\nsurface.label = 3\n" + mask), 0);
  EXPECT_EQ(outside(least_config("labels.mode = \"each\"\n" + mask + "outside = 7\n")), 7);
  const Config written = parse(least_config("labels.mode = \"shared\"\n" + mask + "outside = 0\n"));
  const Config unwritten = parse(least_config("labels.mode = \"shared\"\n" + mask));
  EXPECT_EQ(parameter_hash(written, Stage::ingest), parameter_hash(unwritten, Stage::ingest));
}

// Those that make no new labels.
TEST(FilterConfig, LabelsTakeSome) {
  for (const char* labels : {"labels.mode = \"each\"\n", "surface.label = 5\n"}) {
    for (const FilterType type : {FilterType::flip, FilterType::permute, FilterType::mask})
      EXPECT_EQ(filters(labels + filter_sample(type)).size(), 1U);
    const std::string mode =
        filter_sample(FilterType::downsample, {{"method", "\"mode\""}, {"sample_type", ""}});
    EXPECT_EQ(filters(labels + mode).size(), 1U);
    EXPECT_EQ(filters(mode).size(), 1U) << "numbers may be labels without being meshed as such";
  }
}

TEST(FilterConfig, EverySurfaceHasThem) {
  const auto all = surfaces_of(
      parse("input.path = \"a\"\nsurface.isovalue = [1, 2]\n" + filter_sample(FilterType::keep)));
  ASSERT_EQ(all.size(), 2U);
  for (const OneSurface& one : all) EXPECT_EQ(one.config.filters.size(), 1U);
}

// Finite doubles of every magnitude that can be the ends of a line.
double any_value() {
  const auto value = std::bit_cast<double>(*rc::gen::arbitrary<std::uint64_t>());
  return std::abs(value) <= 1e300 ? value + 0.0 : 0.1;
}
std::int64_t any_whole(std::int64_t least, std::int64_t most) {
  return *rc::gen::inRange<std::int64_t>(least, most + 1);
}
bool maybe() {
  return *rc::gen::arbitrary<bool>();
}

FilterConfig any_filter() {
  using enum FilterType;
  FilterConfig filter;
  filter.type = *rc::gen::elementOf(filter_items().kinds());
  const FilterType type = filter.type;
  if (type == window) {
    filter.clip = {any_value(), 0};
    filter.clip[1] = std::nextafter(filter.clip[0], 1e308) + *rc::gen::inRange(0, 1000);
    if (maybe()) filter.scale = {{filter.clip[1], any_value()}};
    if (filter.scale && (*filter.scale)[0] == (*filter.scale)[1]) filter.scale.reset();
  }
  const auto fraction = [] { return static_cast<double>(any_whole(0, 1 << 20)) / (1 << 20); };
  if (type == gaussian) filter.sigma = {50 * fraction(), 0.001, fraction()};
  const std::int64_t widest = type == median ? most_median_radius : 50;
  if (type == mean || type == median) filter.radius = {any_whole(0, widest), 0, widest};
  if (type == downsample) {
    filter.factor = {any_whole(1, 64), any_whole(2, 9), 1};
    filter.method = static_cast<FilterConfig::Method>(*rc::gen::inRange(0, 3));
  }
  const bool retyped = type == window || type == gaussian || type == mean ||
                       (type == downsample && filter.method == FilterConfig::Method::mean);
  if (retyped && maybe()) filter.sample_type = static_cast<SampleType>(*rc::gen::inRange(0, 10));
  if (type == flip) filter.flipped = {true, maybe(), maybe()};
  if (type == permute)
    filter.order = *rc::gen::element(std::array{1, 0, 2}, std::array{1, 2, 0}, std::array{2, 0, 1});
  if (type == mask) {
    filter.path = "/masks/\"a\" mask.nrrd";
    if (maybe()) filter.values = {{1, 1}, {5, 9}, {std::uint64_t{1} << 63, highest_label}};
  }
  if (type == mask || (type == keep && maybe())) filter.outside = any_value();
  if (type == keep) filter.min_voxels = any_whole(0, std::int64_t{1} << 40);
  if (type == fill) filter.max_voxels = any_whole(1, std::int64_t{1} << 40);
  if (type == fill && maybe()) filter.inside = any_value();
  return filter;
}

RC_GTEST_PROP(FilterConfig, CanonicalTomlReadsBackEqual, ()) {
  Config config = parse(least_config());
  for (int i = *rc::gen::inRange(0, 5); i > 0; --i) config.filters.push_back(any_filter());
  const std::string text = canonical_toml(config);
  const Config again = parse_config(text, "/elsewhere/other.toml");
  RC_ASSERT(again == config);
  RC_ASSERT(canonical_toml(again) == text);
  RC_ASSERT(config_fingerprint(again) == config_fingerprint(config));
  RC_ASSERT(parameter_hash(again, Stage::ingest) == parameter_hash(config, Stage::ingest));
  RC_ASSERT(changed_settings(config, again).empty());
}

}  // namespace
}  // namespace voxweld
