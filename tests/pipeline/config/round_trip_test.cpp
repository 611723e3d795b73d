// Any config the loader can make is written and read back as an equal one.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "pipeline/config/settings.h"
#include "tests/pipeline/config/config_texts.h"

namespace voxweld {
namespace {

bool chance() {
  return *rc::gen::arbitrary<bool>();
}

template <class Enum>
Enum any_of(int count) {
  return static_cast<Enum>(*rc::gen::inRange(0, count));
}

// Finite doubles of every magnitude, by their bits.
double any_nonzero() {
  const auto value = std::bit_cast<double>(*rc::gen::arbitrary<std::uint64_t>());
  return std::isfinite(value) && value != 0 ? value : 0.1;
}

double any_positive() {
  return std::abs(any_nonzero());
}

// Quotes, backslashes, letters beyond ASCII; no control characters, which paths refuse.
std::filesystem::path any_path() {
  const auto pieces =
      *rc::gen::nonEmpty(rc::gen::container<std::vector<std::string>>(rc::gen::element<std::string>(
          "a", "\"", "\\", "'", " ", "#", "=", "\xc3\xa9", "{", "%d", "x")));
  std::string name;
  for (const std::string& piece : pieces) name += piece;
  return "/data/" + name;
}

std::int64_t power_of_two(int least, int most) {
  return std::int64_t{1} << *rc::gen::inRange(least, most + 1);
}

InputConfig any_input() {
  InputConfig in;
  in.path = any_path();
  in.format = *rc::gen::element<std::string>("auto", "nrrd", "nifti", "raw", "zarr", "stack");
  const auto coordinate = rc::gen::inRange<std::int64_t>(0, 100000);
  const auto extent = rc::gen::inRange<std::int64_t>(1, 100000);
  if (chance()) {
    const Index3 lo{*coordinate, *coordinate, *coordinate};
    in.crop = Box3{lo, lo + Index3{*extent, *extent, *extent}};
  }
  if (chance()) in.spacing = Vec3{any_positive(), any_positive(), any_positive()};
  if (chance()) in.unit = *rc::gen::element<std::string>("m", "cm", "mm", "um", "nm", "angstrom");
  in.follow = chance();
  if (chance()) in.select.dataset = *rc::gen::element<std::string>("/entry/data", "density", "#1");
  if (chance()) in.select.series = *rc::gen::element<std::string>("1.2.840.1", "3");
  for (auto* number : {&in.select.level, &in.select.channel, &in.select.time})
    if (chance()) *number = *rc::gen::inRange<std::int64_t>(0, 1'000'001);
  in.resample = any_of<Resample>(2);
  const bool raw = in.format == "raw";
  if (raw || (in.format == "auto" && chance())) {
    in.size = Index3{*extent, *extent, *extent};
    in.type = any_of<SampleType>(10);
    in.endian = any_of<InputConfig::Endian>(2);
    in.header_bytes = *rc::gen::inRange<std::int64_t>(0, std::numeric_limits<std::int64_t>::max());
  }
  return in;
}

InputConfig any_mesh() {
  InputConfig in;
  in.path = any_path().string() + ".stl";
  in.format = "mesh";
  if (chance())
    in.resolution = *rc::gen::inRange<std::int64_t>(4, 500000);
  else
    in.cell = any_positive();
  in.margin = *rc::gen::inRange<std::int64_t>(1, 100);
  in.close = any_of<MeshClosing>(2);
  if (chance()) in.unit = "mm";
  return in;
}

WorkConfig any_work() {
  WorkConfig work;
  work.directory = any_path();
  work.chunk = power_of_two(3, 8);
  work.brick = power_of_two(4, 8);
  work.shard = power_of_two(0, 4);
  work.copy = any_of<WorkConfig::Copy>(3);
  work.chunk = std::min(work.chunk, work.brick * work.shard);
  return work;
}

// Ascending and apart, as they are kept; the first may be empty.
std::vector<LabelRange> any_ranges() {
  std::vector<LabelRange> ranges;
  std::uint64_t next = *rc::gen::inRange<std::uint64_t>(0, 1000);
  const int count = *rc::gen::inRange(0, 5);
  for (int i = 0; i < count; ++i) {
    const std::uint64_t first = next + (chance() ? 0 : std::uint64_t{1} << 60);
    const std::uint64_t last = first + *rc::gen::inRange<std::uint64_t>(0, 10);
    ranges.push_back({first, last});
    next = last + 2 + *rc::gen::inRange<std::uint64_t>(0, 10);
  }
  if (chance()) ranges.push_back({std::uint64_t{1} << 63, highest_label});
  return ranges;
}

LabelsConfig any_labels() {
  LabelsConfig labels;
  labels.mode = any_of<LabelMode>(3);
  if (chance()) labels.map = any_path();
  labels.background = any_ranges();
  labels.selected = any_ranges();
  if (!labels.selected.empty())
    labels.select = LabelsConfig::Select::listed;
  else if (!labels.map.empty() && chance())
    labels.select = LabelsConfig::Select::mapped;
  labels.min_voxels = *rc::gen::inRange<std::int64_t>(0, 1000);
  if (chance()) labels.max_voxels = labels.min_voxels + *rc::gen::inRange<std::int64_t>(0, 1000);
  return labels;
}

OutputConfig any_output() {
  OutputConfig output;
  output.directory = any_path() / "meshes";  // where neither the input lies nor the work
  using Formats = std::vector<std::string>;
  output.formats = *rc::gen::element(Formats{"drc"}, Formats{"glb"}, Formats{"drc", "glb"});
  output.merged = any_of<OutputConfig::Merged>(3);
  output.tiles = output.merged == OutputConfig::Merged::never || chance();
  output.tile_vertices = *rc::gen::inRange<std::int64_t>(1024, 1000000000);
  output.precision = any_positive();
  output.normals = chance();
  output.report = chance();
  return output;
}

std::string any_name() {
  return *rc::gen::element<std::string>("", "long", "a,b", "42", "x.y_z-1", "\xc3\xa9");
}

SlurmConfig any_slurm() {
  SlurmConfig slurm;
  slurm.partition = any_name();
  slurm.account = any_name();
  slurm.qos = any_name();
  slurm.time = *rc::gen::element<std::string>("90", "4:30", "4:00:00", "1-12", "1-12:30:01");
  slurm.cpus_per_task = *rc::gen::inRange<std::int64_t>(1, 1025);
  if (chance()) slurm.mem = std::uint64_t{1} << 62;
  slurm.max_array = *rc::gen::inRange<std::int64_t>(1, 1000001);
  slurm.max_running = *rc::gen::inRange<std::int64_t>(0, 1000001);
  slurm.shards_per_task = *rc::gen::inRange<std::int64_t>(0, 1000);
  slurm.retries = *rc::gen::inRange<std::int64_t>(0, 101);
  if (chance()) slurm.extra = {"--comment=\"a \\ b\"", "-C gpu"};
  if (chance()) slurm.prologue = {"", "export A='b \"c\"'", "# $HOME"};
  return slurm;
}

SurfaceConfig any_surface() {
  SurfaceConfig surface;
  if (chance())
    surface.isovalue = any_nonzero();
  else
    surface.isovalue_rule = any_of<IsovalueRule>(2);
  surface.inside = any_of<SurfaceConfig::Inside>(2);
  if (surface.inside == SurfaceConfig::Inside::above && chance()) {
    surface.label = *rc::gen::inRange<std::uint64_t>(0, ~std::uint64_t{0});
    surface.isovalue = Isovalue::of(*surface.label);
  }
  surface.border = any_of<SurfaceConfig::Border>(2);
  surface.gradient = any_of<SurfaceConfig::Gradient>(4);
  return surface;
}

Config any_config() {
  Config config;
  config.input = any_input();
  config.work = any_work();
  config.surface = any_surface();
  if (chance()) {
    config.input = any_mesh();
    config.surface = {};
    config.surface.isovalue = 1;  // what stands for it inside
  }
  config.simplify.enabled = chance();
  config.simplify.tolerance = any_positive();
  config.simplify.tolerance_unit = any_of<SimplifyConfig::Unit>(2);
  config.simplify.metric = any_of<SimplifyConfig::Metric>(2);
  config.simplify.topology = any_of<SimplifyConfig::Topology>(3);
  config.simplify.qef = any_of<SimplifyConfig::Qef>(2);
  config.simplify.refine = any_of<SimplifyConfig::Refine>(2);
  if (config.simplify.topology != SimplifyConfig::Topology::free)
    config.simplify.refine = any_of<SimplifyConfig::Refine>(4);
  config.simplify.intersections = any_of<SimplifyConfig::Intersections>(3);
  if (refine_mode(config) == SimplifyConfig::Refine::collapse) {
    if (*rc::gen::arbitrary<bool>())
      config.simplify.triangles = *rc::gen::inRange<std::int64_t>(1, 1'000'000);
    else if (*rc::gen::arbitrary<bool>())
      config.simplify.ratio = *rc::gen::inRange(1, 1001) / 1000.0;
  }
  // Its modes exclude keys of other tables.
  config.labels = any_labels();
  if (config.input.is_mesh()) config.labels.mode = LabelMode::off;
  if (config.labels.mode != LabelMode::off) {
    config.surface.label.reset();
    config.surface.inside = SurfaceConfig::Inside::above;
    if (config.simplify.topology == SimplifyConfig::Topology::free)
      config.simplify.topology = SimplifyConfig::Topology::safe;
    config.surface.isovalue = any_nonzero();
  }
  if (config.surface.isovalue) config.surface.isovalue_rule = IsovalueRule::otsu;
  if (config.input.has_samples() && !config.surface.isovalue && chance()) {
    config.surface.isovalue_rule = IsovalueRule::otsu;
    config.surface.isovalues = {{any_nonzero(), {}},
                                {Isovalue::of(~std::uint64_t{0}), {}},
                                {std::nullopt, IsovalueRule::valley}};
  }
  config.output = any_output();
  if (config.labels.mode == LabelMode::each) {
    config.output.merged = OutputConfig::Merged::automatic;
    config.output.tiles = true;
  } else if (refines(config) && config.output.tiles) {
    config.output.levels = *rc::gen::inRange<std::int64_t>(0, 13);
  }
  config.run.executor = any_of<RunConfig::Executor>(2);
  config.slurm = any_slurm();
  config.run.threads = *rc::gen::inRange<std::int64_t>(0, 4097);
  config.run.memory = *rc::gen::inRange<std::uint64_t>(64U << 20, std::uint64_t{1} << 62);
  if (chance()) config.run.memory &= ~((std::uint64_t{1} << 20) - 1);
  return config;
}

RC_GTEST_PROP(RoundTrip, CanonicalTomlReadsBackEqual, ()) {
  const Config config = any_config();
  const std::string text = canonical_toml(config);
  // Everything is absolute, so the place of the file does not matter.
  const Config again = parse_config(text, "/elsewhere/other.toml");
  RC_ASSERT(again == config);
  RC_ASSERT(canonical_toml(again) == text);
  RC_ASSERT(config_fingerprint(again) == config_fingerprint(config));
  RC_ASSERT(changed_settings(config, again).empty());
}

TEST(RoundTrip, CanonicalTomlOfDefaults) {
  const std::string text = canonical_toml(testing::parse(testing::least_config()));
  EXPECT_EQ(text.substr(0, text.find("[surface]")), R"([input]
path = "/data/scan.nrrd"
format = "auto"
# crop: the whole volume
# spacing: as the file says, else 1
# unit: as the file says
# dataset: the only one there is
# series: the only one there is
# level: the finest
# channel: the only one there is
# time: the only one there is
# resample: "none"
# size: none; raw files and empty space need it
# type: none; raw files need it
endian = "little"
header_bytes = 0
follow = false
# resolution: none; meshes need it, or input.cell
# cell: none; meshes need it, or input.resolution
margin = 1
close = "no"

[work]
directory = "/data/scan.work"
chunk = 32
brick = 64
shard = 4
copy = "auto"

)");
}

}  // namespace
}  // namespace voxweld
