#include "pipeline/cli/init_hints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <type_traits>

#include "pipeline/phantom/write.h"
#include "stages/ingest/histogram_bins.h"
#include "stages/ingest/threshold.h"

namespace voxweld {
namespace {

// Of samples that may be signed distances, or another field whose surface is at 0, the share below 0: floats
// on both sides of 0, whose histogram has no two clear classes. Such a field has no fewer samples at its
// surface than elsewhere, so no rule finds the surface by their number.
std::optional<double> signed_field(const Histogram& histogram, const ValueScale& scale) {
  constexpr double clear = 0.8;         // of two classes
  constexpr double least_share = 0.01;  // of the samples, and of the range, on either side of 0
  const bool floats = histogram.type == SampleType::f32 || histogram.type == SampleType::f64;
  if (!floats || !scale.identity()) return std::nullopt;
  const auto threshold = otsu_threshold(histogram);
  if (!threshold || threshold->separability >= clear) return std::nullopt;
  double below = 0, all = 0, lowest = 0, highest = 0;
  for (const HistogramBin& bin : histogram.bins) {
    const double value = histogram_bin_value(histogram.type, bin.bin);
    if (!std::isfinite(value)) continue;
    const auto count = static_cast<double>(bin.count);
    all += count;
    if (value < 0) below += count;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  const auto much = [](double part, double of) { return part > least_share * of; };
  const bool both = much(below, all) && much(all - below, all) && much(-lowest, highest) &&
                    much(highest, -lowest);
  return both ? std::optional(below / all) : std::nullopt;
}

}  // namespace

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

std::vector<std::string> volume_hints(const std::string& path, const SeenVolume& seen,
                                      GivenOptions given) {
  const VolumeInfo& info = seen.info;
  std::vector<std::string> hints;
  const bool scaled = !info.scale.identity();
  if (!given.labels && !scaled && seen.look.like_labels())
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
  if (given.labels || info.surface) return hints;
  const bool may_be_phantom = info.format == "nrrd" && !info.files.empty();
  const auto surface =
      may_be_phantom ? phantom_surface(info.files.front().path) : std::optional<PhantomSurface>();
  if (surface)
    hints.push_back(
        fmt::format("hint: {}: a phantom whose true surface is at surface.isovalue = {}, "
                    "surface.inside = \"{}\"; the config has what the histogram suggests",
                    path, surface->isovalue, surface->inside));
  else if (const auto below = signed_field(seen.histogram, info.scale))
    hints.push_back(fmt::format(
        "hint: {}: {:.0f} % of the samples are below 0, and the histogram has no two clear "
        "classes; if they are signed distances, set surface.isovalue = 0, and surface.inside = "
        "\"below\" where they are negative inside",
        path, 100 * *below));
  return hints;
}

std::vector<std::string> mesh_hints(const std::string& path, GivenOptions given) {
  if (given.unit) return {};
  return {fmt::format(
      "hint: {}: a mesh says no unit of its coordinates; --unit says which, for example --unit mm",
      path)};
}

}  // namespace voxweld
