// Which page of which file is which slice of a stack.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "storage/image/image_file.h"
#include "storage/image/stack_calibration.h"
#include "storage/types/volume_reader.h"

namespace voxweld {

struct StackPlane {
  std::size_t file = 0, page = 0;
};

struct StackPlan {
  std::vector<std::filesystem::path> files;
  std::vector<StackPlane> planes;  // by z, at least one
  bool paged = false;              // slices are pages of a file; else each is a file of one page
  std::optional<int> channel{};    // which of the samples of a pixel; unset where it has one
  int level = 0;                   // of the resolutions of each page
  // Where each slice begins in the one file, if all follow the first raw; `planes` are then all its
  // one page.
  std::vector<std::uint64_t> raw_offsets{};
  StackCalibration calibration{};
  std::vector<InputChoice> choices{};
  std::vector<std::string> warnings{};
};

// Lists the files of spec.path and finds out what they hold, from names and from the description of
// the first: as OME-TIFF, ImageJ, or plain. Throws as open_stack() does.
StackPlan plan_stack(const InputSpec& spec);

// Something of which one is read.
struct StackChoice {
  Selector selector;
  std::int64_t count = 1;
  std::function<std::string(std::int64_t)> text;  // what one would choose by; may be empty
};
// Which it is: what was asked for, the only one, or in a survey the first. Lists them in the plan
// where there are several. InputError where it is left open or there is no such thing.
std::int64_t choose_one(const StackChoice& of, const InputSpec& spec, StackPlan& plan);

// The first page of a stack.
struct StackStart {
  ImageFile& file;
  ImagePage page;
  std::size_t index = 0;  // in the file
};
// Chooses of the resolutions of the page; sets plan.level.
void choose_level(const StackStart& start, const InputSpec& spec, StackPlan& plan);
// Chooses of `planes` channels that have pages of their own, times the samples of a pixel; sets
// plan.channel. `names` are those of the former; they may be fewer. Returns which of the planes.
std::int64_t choose_channel(const StackStart& start, std::int64_t planes,
                            const std::vector<std::string>& names, const InputSpec& spec,
                            StackPlan& plan);

// The two that a description tells of. Of OME plan.files holds the TIFF that was opened, or nothing
// where it was a companion file, and becomes all that there are.
void plan_imagej(const StackStart& start, const InputSpec& spec, StackPlan& plan);
void plan_ome(const std::string& xml, const InputSpec& spec, StackPlan& plan);

}  // namespace voxweld
