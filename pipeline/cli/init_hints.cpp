#include "pipeline/cli/init_hints.h"

#include <fmt/format.h>

#include <cstring>
#include <type_traits>

#include "pipeline/phantom/write.h"

namespace voxweld {

void LabelLook::add(const Box3& band, std::span<const std::byte> samples) {
  dispatch_sample_type(type_, [&](auto tag) {
    using T = typename decltype(tag)::type;
    if constexpr (std::is_integral_v<T>) {
      const auto width = static_cast<std::size_t>(band.size().x);
      constexpr std::size_t every = 4;  // rows: enough to tell
      const std::size_t rows = samples.size() / sizeof(T) / width;
      std::vector<T> row(width);
      for (std::size_t r = 0; r < rows; r += every) {
        std::memcpy(row.data(), samples.data() + r * width * sizeof(T), width * sizeof(T));
        for (std::size_t i = 1; i + 2 < width; ++i) {
          if (row[i] == row[i + 1]) continue;
          ++changes_;
          if (row[i - 1] == row[i] && row[i + 1] == row[i + 2]) ++steps_;
          if constexpr (std::is_signed_v<T>) negative_ = negative_ || row[i] < 0 || row[i + 1] < 0;
        }
      }
    }
  });
}

bool LabelLook::like_labels() const {
  constexpr std::uint64_t least_changes = 16;
  constexpr double least_share = 0.6;
  return !negative_ && changes_ >= least_changes &&
         static_cast<double>(steps_) >= least_share * static_cast<double>(changes_);
}

std::vector<std::string> volume_hints(const std::string& path, const VolumeInfo& info,
                                      const LabelLook& look, GivenOptions given) {
  std::vector<std::string> hints;
  const bool scaled = !info.scale.identity();
  if (!given.labels && !scaled && look.like_labels())
    hints.push_back(fmt::format(
        "hint: {}: the samples look like labels; with --labels each label gets a mesh", path));
  const bool bare = info.format == "stack" || info.format == "raw";
  if (bare && !given.spacing && info.geometry.spacing == Vec3{1, 1, 1})
    hints.push_back(
        fmt::format("hint: {}: says no spacing, so 1 x 1 x 1 is taken; --spacing and --unit say "
                    "how far apart samples are",
                    path));
  else if (bare && !given.unit && info.geometry.unit.empty())
    hints.push_back(fmt::format(
        "hint: {}: says no unit of its spacing; --unit says which, for example --unit mm", path));
  if (given.labels || info.format != "nrrd" || info.files.empty()) return hints;
  if (const auto surface = phantom_surface(info.files.front().path))
    hints.push_back(
        fmt::format("hint: {}: a phantom whose true surface is at surface.isovalue = {}, "
                    "surface.inside = \"{}\"; the config has what the histogram suggests",
                    path, surface->isovalue, surface->inside));
  return hints;
}

std::vector<std::string> mesh_hints(const std::string& path, GivenOptions given) {
  if (given.unit) return {};
  return {fmt::format(
      "hint: {}: a mesh says no unit of its coordinates; --unit says which, for example --unit mm",
      path)};
}

}  // namespace voxweld
