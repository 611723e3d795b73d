#include "pipeline/cli/volume_arguments.h"

#include <fmt/format.h>

#include "pipeline/cli/number_option.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

std::string known_formats() {
  std::string text = "Volumes are told by their contents, else by their names:";
  for (const VolumeReader& reader : volume_readers())
    text += fmt::format("\n  {:<10} {}", reader.name, reader.files);
  return text;
}

void add_selection(CLI::App& command, VolumeArguments& arguments) {
  const char* group = "Which volume, where a file or folder holds several";
  InputSelection& select = arguments.select;
  command.add_option("--dataset", select.dataset, "Path or name of the array or grid in the file")
      ->group(group);
  command.add_option("--series", select.series, "DICOM: UID of the series, or its number")
      ->group(group);
  const auto number = [&](const char* name, std::optional<std::int64_t>& value, const char* text) {
    command.add_option(name, value, text)->check(whole_number())->group(group);
  };
  number("--level", select.level, "Which resolution; 0 is the finest");
  number("--channel", select.channel, "Which channel, counted from 0");
  number("--time", select.time, "Which point in time, counted from 0");
  add_value(command, "--resample", arguments.resample,
            "DICOM: \"uniform\" interpolates slices that are not equally far apart")
      ->check(CLI::IsMember({"none", "uniform"}))
      ->group(group);
}

}  // namespace

void add_volume_options(CLI::App& command, VolumeArguments& arguments) {
  command.footer(known_formats());
  const char* group = "Headerless (raw) files, and what a file does not say";
  add_numbers(command, "--size", arguments.size, {3}, "Raw: samples along x (fastest), y, z")
      ->group(group);
  command.add_option("--type", arguments.type, "Raw: type of a sample, such as uint16 or float32")
      ->group(group);
  add_value(command, "--endian", arguments.endian, "Raw: byte order of a sample")
      ->check(CLI::IsMember({"little", "big"}))
      ->group(group);
  add_value(command, "--header-bytes", arguments.header_bytes, "Raw: bytes before the first sample")
      ->check(whole_number())
      ->group(group);
  command
      .add_flag("--follow", arguments.follow,
                "NRRD and MetaImage: lets the header name data files outside its folder")
      ->group(group);
  add_numbers(command, "--spacing", arguments.spacing, {1, 3},
              "Distance of neighbouring samples: one number, or along x, y, z")
      ->group(group);
  command.add_option("--unit", arguments.unit, "Unit of the spacing")
      ->check(CLI::IsMember({"m", "cm", "mm", "um", "nm", "angstrom"}))
      ->group(group);
  add_selection(command, arguments);
}

Resample resample_of(const VolumeArguments& arguments) {
  return arguments.resample == "uniform" ? Resample::uniform : Resample::none;
}

InputSpec input_spec(const VolumeArguments& arguments) {
  InputSpec spec;
  spec.path = arguments.path;
  if (arguments.size.empty() != arguments.type.empty())
    throw InputError(fmt::format("{}: --{} without --{}: raw samples need both", arguments.path,
                                 arguments.size.empty() ? "type" : "size",
                                 arguments.size.empty() ? "size" : "type"));
  if (!arguments.size.empty()) {
    spec.format = "raw";
    spec.raw.size = {arguments.size[0], arguments.size[1], arguments.size[2]};
    spec.raw.type = parse_sample_type(arguments.type);
    if (!spec.raw.type)
      throw InputError(fmt::format(
          "--type {}: unknown; use uint8, int8, uint16, int16, uint32, int32, uint64, int64, "
          "float32 or float64",
          arguments.type));
  }
  spec.raw.byte_order = arguments.endian == "big" ? std::endian::big : std::endian::little;
  spec.raw.header_bytes = arguments.header_bytes;
  const std::vector<double>& s = arguments.spacing;
  if (s.size() == 1) spec.spacing = {s[0], s[0], s[0]};
  if (s.size() == 3) spec.spacing = {s[0], s[1], s[2]};
  spec.unit = arguments.unit;
  spec.follow = arguments.follow;
  spec.select = arguments.select;
  spec.resample = resample_of(arguments);
  return spec;
}

ScanHooks scan_hooks(Program& program, const std::string& what) {
  ScanHooks hooks;
  hooks.interrupt = &program.interrupt;
  hooks.progress = [&program, what](double share) {
    if (shows_progress(program.log_level))
      program.console->status(fmt::format("{} {:.0f} %", what, 100 * share));
  };
  return hooks;
}

}  // namespace voxweld
