#include "tests/pipeline/run/label_volumes.h"

#include <fmt/format.h>

#include <cstring>

#include "storage/manifest/manifest.h"
#include "storage/support/file_io.h"
#include "storage/support/hash.h"
#include "tests/support/lattice_place.h"

namespace voxweld::testing {

RawVolume ball_labels(SampleType type, Index3 size) {
  return integer_volume(type, size, [&](Index3 at) {
    const Index3 cell{at.x / 16, at.y / 16, at.z / 16};
    const Index3 d = at - cell * 16 - splat(8);
    if (d.x * d.x + d.y * d.y + d.z * d.z >= 81) return std::int64_t{0};
    const std::int64_t more = sample_bytes(type) == 8 ? std::int64_t{1} << 40 : 0;
    return 1 + cell.x + 10 * cell.y + 100 * cell.z + more;
  });
}

RawVolume cell_labels(Index3 size, std::uint32_t labels, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> one(0, 1);
  std::vector<Vec3> centres;
  for (std::uint32_t i = 0; i < labels; ++i)
    centres.push_back({one(random) * static_cast<double>(size.x),
                       one(random) * static_cast<double>(size.y),
                       one(random) * static_cast<double>(size.z)});
  return integer_volume(SampleType::u16, size, [&](Index3 s) {
    const Vec3 at = as_vec3(s);
    std::uint32_t nearest = 0;
    for (std::uint32_t i = 1; i < labels; ++i) {
      const Vec3 d = centres[i] - at, best = centres[nearest] - at;
      if (dot(d, d) < dot(best, best)) nearest = i;
    }
    const bool is_noise = one(random) < noise;
    return is_noise ? random() % (labels + 1) : nearest + 1;
  });
}

std::set<std::uint64_t> labels_of(const RawVolume& volume) {
  std::set<std::uint64_t> labels;
  const std::size_t width = sample_bytes(volume.type);
  for (std::size_t at = 0; at < volume.samples.size(); at += width) {
    std::uint64_t label = 0;
    std::memcpy(&label, volume.samples.data() + at, width);
    labels.insert(label);
  }
  return labels;
}

Tree label_files(const std::filesystem::path& output, std::uint64_t label) {
  Tree files;
  TileListReader tiles(output / tiles_name);
  while (const auto tile = tiles.next()) {
    if (tile->label && *tile->label != label) continue;
    const Index3 at = tile->tile.at;
    for (const FileRecord& file : tile->files)
      files[fmt::format("{}-{}-{}-{}.{}", tile->tile.level, at.x, at.y, at.z, file.format)] =
          to_hex(hash_bytes(read_whole_file(output / file.path)));
  }
  return files;
}

void expect_labels_as_alone(const RawVolume& volume, const Settings& settings,
                            std::size_t several_tiles) {
  const Scene scene(volume);
  VOXWELD_EXPECT_DONE(scene.run_in("all", Settings{"labels.mode=each"} + settings));
  std::size_t several = 0;
  const std::set<std::uint64_t> labels = labels_of(volume);
  for (const std::uint64_t label : labels) {
    if (label == 0) continue;
    const Settings alone = {fmt::format("surface.label={}", label),
                            fmt::format("surface.isovalue={}", label)};
    scene.forget("one");
    VOXWELD_EXPECT_DONE(scene.run_in("one", alone + settings));
    const Tree expected = label_files(scene.output("one"), label);
    EXPECT_EQ(difference(expected, label_files(scene.output("all"), label)), "") << label;
    EXPECT_FALSE(expected.empty());
    several += expected.size() > 2;
  }
  EXPECT_GE(several, several_tiles);
  EXPECT_EQ(manifest_of(scene.output("all")).at("counts").at("labels"),
            labels.size() - labels.count(0));
}

}  // namespace voxweld::testing
