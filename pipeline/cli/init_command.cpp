#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <filesystem>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/config_path.h"
#include "pipeline/cli/init_hints.h"
#include "pipeline/cli/output_file.h"
#include "pipeline/cli/volume_arguments.h"
#include "pipeline/config/commented.h"
#include "pipeline/info/label_survey.h"
#include "pipeline/solids/mesh_input.h"
#include "pipeline/solids/mesh_survey.h"
#include "stages/ingest/histogram_bins.h"
#include "stages/ingest/threshold.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

struct InitArguments {
  VolumeArguments volume;
  std::string output;
  bool force = false;
  bool full = false;  // all keys, not only what one is likely to change
  // How finely a mesh is sampled.
  std::optional<std::int64_t> resolution;
  std::optional<double> cell;
  bool labels = false;
  std::string close = "no";
};

// Cells along a mesh's longest side where nothing is said of it.
constexpr std::int64_t usual_resolution = 256;

// "scan" for scan.nii.gz, a folder scan/ and a pattern scan/*.tif or scan_*.tif.
std::string input_stem(const std::string& input) {
  fs::path path = fs::path(input).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  std::string name = path.filename().string();
  const auto wildcard = name.find_first_of("*?[");
  if (wildcard != std::string::npos) {
    name.resize(wildcard);
    while (!name.empty() && std::string("_-. ").find(name.back()) != std::string::npos)
      name.pop_back();
    if (name.empty()) name = fs::absolute(path).parent_path().filename().string();
  } else if (std::error_code ignored; !fs::is_directory(path, ignored)) {
    fs::path stem = path.stem();
    if (path.extension() == ".gz") stem = stem.stem();
    name = stem.string();
  } else {
    if (name == "." || name == "..") name = fs::canonical(path).filename().string();
    if (fs::path(name).extension() == ".zarr") name = fs::path(name).stem().string();
  }
  return name.empty() ? "volume" : name;
}

fs::path config_path(const InitArguments& arguments) {
  fs::path path = arguments.output.empty() ? fs::path(input_stem(arguments.volume.path) + ".toml")
                                           : fs::path(arguments.output);
  refuse_input(path, arguments.volume.path);
  check_free(path, arguments.force);
  return path;
}

// Material seldom fills the border of a scan: the side most of its samples are on is taken for
// outside.
SurfaceConfig::Inside suggest_inside(const Histogram& border, const ValueScale& scale,
                                     double isovalue, std::optional<double> padding) {
  std::uint64_t above = 0, below = 0;
  for (const HistogramBin& bin : border.bins) {
    const double value = scale.real(histogram_bin_value(border.type, bin.bin));
    if (padding && value == *padding) continue;
    (value >= isovalue ? above : below) += bin.count;
  }
  return above > below ? SurfaceConfig::Inside::below : SurfaceConfig::Inside::above;
}

void suggest_surface(const InitArguments& arguments, const VolumeInfo& info, const ScanResult& scan,
                     InitSuggestion& suggestion) {
  if (info.surface) {
    suggestion.isovalue = info.surface->isovalue;
    suggestion.inside =
        info.surface->inside_below ? SurfaceConfig::Inside::below : SurfaceConfig::Inside::above;
    return;
  }
  const auto isovalue = suggest_isovalue(scan.histogram, info.scale);
  const ValueRange range = real_range(scan.range, info.scale);
  if (!isovalue && range.lo < range.hi)
    throw InputError(fmt::format(
        "{}: the samples run from {} to {}, too close together for a histogram to suggest an "
        "isovalue; write a config with a surface.isovalue between the two",
        arguments.volume.path, isovalue_text(range.lo), isovalue_text(range.hi)));
  if (!isovalue) {
    const std::string found =
        range.empty ? "no sample is a number" : fmt::format("all samples are {}", range.lo);
    throw InputError(fmt::format(
        "{}: {}, so there is no surface in it; check that it is read as it was written ({} x {} x "
        "{} {})",
        arguments.volume.path, found, info.geometry.size.x, info.geometry.size.y,
        info.geometry.size.z, sample_type_name(info.type)));
  }
  if (isovalue->padding)
    spdlog::info("samples of {} are taken for padding and left out", *isovalue->padding);
  suggestion.isovalue = isovalue->threshold.value;
  suggestion.inside =
      suggest_inside(scan.border, info.scale, suggestion.isovalue, isovalue->padding);
}

InitSuggestion suggest(const InitArguments& arguments, const fs::path& config,
                       const VolumeInfo& info, const ScanResult& scan) {
  InitSuggestion suggestion;
  suggestion.path = path_for_config(arguments.volume.path, config);
  suggestion.labels = arguments.labels;
  if (!arguments.labels) suggest_surface(arguments, info, scan, suggestion);
  const ValueRange range = real_range(scan.range, info.scale);
  suggestion.lowest = range.lo;
  suggestion.highest = range.hi;
  suggestion.endian =
      arguments.volume.endian == "big" ? InputConfig::Endian::big : InputConfig::Endian::little;
  suggestion.header_bytes = arguments.volume.header_bytes;
  if (!arguments.volume.spacing.empty()) suggestion.spacing = info.geometry.spacing;
  suggestion.unit = arguments.volume.unit;
  suggestion.follow = arguments.volume.follow;
  suggestion.select = arguments.volume.select;
  suggestion.resample = resample_of(arguments.volume);
  return suggestion;
}

ConfigExtent extent_of(const InitArguments& arguments) {
  return arguments.full ? ConfigExtent::full : ConfigExtent::brief;
}

void write_config(const fs::path& config, const std::string& text) {
  parse_config(text, fs::absolute(config));  // what is written loads
  write_whole_file(config, as_bytes(text), Durability::fsync);
}

GivenOptions given_options(const InitArguments& arguments) {
  return {!arguments.volume.spacing.empty(), !arguments.volume.unit.empty(), arguments.labels};
}

void say(const std::vector<std::string>& hints) {
  for (const std::string& hint : hints) spdlog::info("{}", hint);
}

int init_mesh(const InitArguments& arguments) {
  const std::string& path = arguments.volume.path;
  if (!arguments.volume.spacing.empty())
    throw InputError("--spacing: a mesh has no samples; --cell says how far apart to take them");
  const fs::path config = config_path(arguments);
  InputConfig input;
  input.path = path;
  input.format = "mesh";
  input.cell = arguments.cell;
  if (!input.cell) input.resolution = arguments.resolution.value_or(usual_resolution);
  if (arguments.close == "winding") input.close = MeshClosing::winding;
  const MeshSummary mesh =
      summary_of_mesh(path, Config{}.run.memory, input.close, fs::absolute(config).parent_path());
  const MeshSuggestion suggestion{path_for_config(path, config),
                                  mesh.format,
                                  mesh.vertices,
                                  mesh.triangles,
                                  mesh.bounds.lo,
                                  mesh.bounds.hi,
                                  mesh_geometry(input, mesh.bounds),
                                  input.resolution,
                                  input.cell,
                                  input.close,
                                  arguments.volume.unit};
  write_config(config, commented_config(suggestion, extent_of(arguments)));
  say(mesh_hints(path, given_options(arguments)));
  const Index3 size = suggestion.geometry.size;
  fmt::print("{}: {} triangles, closed{} ({})\n", path, suggestion.triangles,
             input.close == MeshClosing::no ? "" : " by winding number", mesh.format);
  fmt::print("{}: {} x {} x {} samples, {:g} apart\n", config.string(), size.x, size.y, size.z,
             suggestion.geometry.spacing.x);
  fmt::print("next: voxweld run {}\n", config.string());
  return 0;
}

std::string found_text(const InitSuggestion& suggestion, const InfoDocument& labels) {
  if (!suggestion.labels)
    return fmt::format("surface.isovalue = {}, surface.inside = \"{}\"", suggestion.isovalue,
                       suggestion.inside == SurfaceConfig::Inside::above ? "above" : "below");
  return fmt::format("labels.mode = \"each\", of {} labels; {:.3g} % are of label 0",
                     labels.at("distinct").get<std::uint64_t>(),
                     100 * labels.at("background_share").get<double>());
}

// Its samples may lie in many files, and beside a header.
void refuse_files_of(const SampleSource& source, const fs::path& config) {
  const VolumeInfo& info = source.info();
  for (const InputFile& file : info.files) refuse_input(config, file.path);
  source.each_file({{}, info.geometry.size},
                   [&](const fs::path& file) { refuse_input(config, file); });
}

int init(const InitArguments& arguments, Program& program) {
  const InputSpec spec = input_spec(arguments.volume);
  if (spec.format == "auto" && is_mesh_name(spec.path)) return init_mesh(arguments);
  if (arguments.resolution || arguments.cell)
    throw InputError(
        fmt::format("--{}: only meshes take it (.stl, .off, .obj, .ply), and {} is none",
                    arguments.cell ? "cell" : "resolution", spec.path));
  const fs::path config = config_path(arguments);
  const std::shared_ptr<SampleSource> source = open_volume(spec);
  const VolumeInfo& info = source->info();
  if (fs::exists(config)) refuse_files_of(*source, config);
  for (const std::string& warning : info.warnings) spdlog::warn("{}", warning);
  ScanResult scan;
  InfoDocument labels;
  LabelLook look(info.type);
  ScanHooks looking = scan_hooks(program, "histogram");
  looking.samples = [&](const Box3& band, std::span<const std::byte> samples) {
    look.add(band, samples);
  };
  if (arguments.labels)
    labels = label_facts(*source, scan_hooks(program, "labels"), scan);
  else
    scan = scan_in_order(*source, looking);
  program.console->clear_status();
  const InitSuggestion suggestion = suggest(arguments, config, info, scan);
  write_config(config, commented_config(info, suggestion, extent_of(arguments)));
  const Index3 size = info.geometry.size;
  fmt::print("{}: {} x {} x {} {} ({}), samples {} to {}\n", arguments.volume.path, size.x, size.y,
             size.z, sample_type_name(info.type), info.format, suggestion.lowest,
             suggestion.highest);
  say(volume_hints(arguments.volume.path, {info, look, scan.histogram}, given_options(arguments)));
  fmt::print("{}: {}\n", config.string(), found_text(suggestion, labels));
  fmt::print("next: voxweld run {}\n", config.string());
  return 0;
}

}  // namespace

void add_init_command(CLI::App& app, Program& program) {
  auto arguments = std::make_shared<InitArguments>();
  CLI::App* command = app.add_subcommand(
      "init",
      "Writes a config for a volume or a closed mesh\n"
      "Reads the volume once, takes an isovalue from its histogram (Otsu's threshold) and writes a "
      "short config with what one is likely to change.");
  add_file(
      *command, "input", arguments->volume.path,
      "A file, a folder or a pattern in quotes: 'slices/*.tif'; or a mesh: .stl, .off, .obj or "
      ".ply");
  command
      ->add_option("-o,--output", arguments->output,
                   "The config to write (default: the input's name + .toml, here)")
      ->type_name("FILE");
  command->add_flag("--force", arguments->force, "Writes over a config that is there");
  command->add_flag("--full", arguments->full,
                    "Writes all keys there are, those at their defaults as comments");
  command->add_flag("--labels", arguments->labels,
                    "The samples are labels: a config that meshes each of them");
  const char* meshes = "Where the input is a mesh";
  auto* resolution =
      command
          ->add_option("--resolution", arguments->resolution,
                       fmt::format("Cells along its longest side (default: {})", usual_resolution))
          ->check(CLI::Range(least_resolution, most_resolution))
          ->group(meshes);
  command->add_option("--cell", arguments->cell, "The side of a cell, in the mesh's unit")
      ->check(CLI::PositiveNumber)
      ->excludes(resolution)
      ->group(meshes);
  add_value(*command, "--close", arguments->close,
            "\"winding\" takes a mesh with holes and closes them, by the winding number")
      ->check(CLI::IsMember({"no", "winding"}))
      ->group(meshes);
  add_volume_options(*command, arguments->volume);
  add_examples(*command,
               {{"voxweld init scan.nii.gz", "writes scan.toml"},
                {"voxweld init 'slices/*.tif' --spacing 0.02 --unit mm -o part.toml",
                 "a stack of images, which seldom say how far apart they are"},
                {"voxweld init scan.raw --size 512 512 300 --type uint16", ""},
                {"voxweld init part.stl --resolution 200", "a mesh, to simplify or to edit"},
                {"voxweld init cells.nrrd --labels", "a mesh for each label"}});
  when_chosen(*command, program, [&program, arguments] { return init(*arguments, program); });
}

}  // namespace voxweld
