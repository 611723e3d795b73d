// What our readers make of a file, for others to compare with: the samples, raw and little-endian,
// x fastest, and beside them what is said about them.
// usage: dump_volume PATH --out FILE [--dataset NAME] [--series UID] [--level N] [--channel N]
//                    [--time N] [--format NAME] [--size X Y Z --type NAME [--endian big]]
//        dump_volume --formats
// Writes FILE and FILE.json. Exit status: 0; 1 the system failed, or a box that is read by itself is
// not what the whole has there; 2 the input is refused, and why is on the standard error.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "storage/readers/open_volume.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/volumes/data_layout.h"

static_assert(std::endian::native == std::endian::little);

namespace {

using namespace voxweld;
using Json = nlohmann::ordered_json;

constexpr std::int64_t piece_bytes = std::int64_t{64} << 20;

Json numbers(Vec3 v) {
  return {v.x, v.y, v.z};
}

Json facts_of(const VolumeInfo& info) {
  const VolumeGeometry& g = info.geometry;
  Json facts = {{"format", info.format},
                {"type", sample_type_name(info.type)},
                {"size", {g.size.x, g.size.y, g.size.z}},
                {"spacing", numbers(g.spacing)},
                {"origin", numbers(g.origin)},
                {"direction", Json::array()},
                {"unit", g.unit},
                {"space", g.space},
                {"slope", info.scale.slope},
                {"intercept", info.scale.intercept},
                {"access", access_name(info.access)},
                {"largest_decode", info.largest_decode},
                {"choices", Json::array()},
                {"warnings", info.warnings}};
  for (const Vec3& axis : g.direction) facts["direction"].push_back(numbers(axis));
  for (const InputChoice& choice : info.choices)
    facts["choices"].push_back({{"selector", choice.selector},
                                {"value", choice.value},
                                {"text", choice.text},
                                {"chosen", choice.chosen}});
  return facts;
}

// Boxes that every source can read, rising: whole slices, of large ones bands of whole rows.
std::vector<Box3> pieces_of_volume(const VolumeInfo& info) {
  const Index3 size = info.geometry.size;
  const auto row = size.x * static_cast<std::int64_t>(sample_bytes(info.type));
  const std::int64_t slice = row * size.y;
  std::int64_t slices = std::clamp<std::int64_t>(piece_bytes / slice, 1, size.z);
  if (slices > info.chunk.z) slices -= slices % info.chunk.z;
  const std::int64_t rows = slice <= static_cast<std::int64_t>(large_slice_bytes)
                                ? size.y
                                : std::clamp<std::int64_t>(piece_bytes / row, 1, size.y);
  std::vector<Box3> pieces;
  for (std::int64_t z = 0; z < size.z; z += slices)
    for (std::int64_t y = 0; y < size.y; y += rows)
      pieces.push_back(
          {{0, y, z}, {size.x, std::min(y + rows, size.y), std::min(z + slices, size.z)}});
  return pieces;
}

std::vector<std::byte> read_box(const SampleSource& source, const Box3& box) {
  std::vector<std::byte> samples(static_cast<std::size_t>(box.count()) *
                                 sample_bytes(source.info().type));
  source.read(box, samples.data());
  return samples;
}

void write_samples(const SampleSource& source, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  for (const Box3& box : pieces_of_volume(source.info())) {
    const std::vector<std::byte> samples = read_box(source, box);
    file.write(reinterpret_cast<const char*>(samples.data()),
               static_cast<std::streamsize>(samples.size()));
  }
  file.close();
  if (!file) throw StorageError("cannot write " + path);
}

std::int64_t below(std::mt19937_64& random, std::int64_t bound) {
  return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(bound));
}

// Small boxes at random, read by themselves, are those of the whole.
void check_boxes(const SampleSource& source, const std::string& path) {
  const VolumeInfo& info = source.info();
  if (info.access != Access::box && info.access != Access::chunks) return;
  const ReadFile whole(path);
  const auto width = static_cast<std::int64_t>(sample_bytes(info.type));
  const Index3 size = info.geometry.size;
  std::mt19937_64 random(11);
  for (int i = 0; i < 12; ++i) {
    Box3 box;
    for (int axis = 0; axis < 3; ++axis) {
      box.lo[axis] = below(random, size[axis]);
      box.hi[axis] = std::min(box.lo[axis] + 1 + below(random, 24), size[axis]);
    }
    const std::vector<std::byte> samples = read_box(source, box);
    std::vector<std::byte> row(static_cast<std::size_t>(box.size().x * width));
    const std::byte* at = samples.data();
    for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
      for (std::int64_t y = box.lo.y; y < box.hi.y; ++y, at += row.size()) {
        whole.read(static_cast<std::uint64_t>(((z * size.y + y) * size.x + box.lo.x) * width), row);
        if (std::memcmp(row.data(), at, row.size()) != 0)
          throw StorageError(
              fmt::format("a box from {}, {}, {} on differs from the whole volume "
                          "in row {}, slice {}",
                          box.lo.x, box.lo.y, box.lo.z, y, z));
      }
  }
}

struct Arguments {
  InputSpec spec;
  std::string out, type, endian = "little";
  std::vector<std::int64_t> size;
  bool formats = false;
};

void declare(CLI::App& app, Arguments& a) {
  app.add_option("path", a.spec.path);
  app.add_option("--out", a.out);
  app.add_option("--format", a.spec.format);
  app.add_option("--dataset", a.spec.select.dataset);
  app.add_option("--series", a.spec.select.series);
  app.add_option("--level", a.spec.select.level);
  app.add_option("--channel", a.spec.select.channel);
  app.add_option("--time", a.spec.select.time);
  app.add_option("--size", a.size)->expected(3);
  app.add_option("--type", a.type);
  app.add_option("--endian", a.endian)->check(CLI::IsMember({"little", "big"}));
  app.add_flag("--formats", a.formats, "the names of the readers, one a line");
}

void dump(Arguments& a) {
  if (a.size.size() == 3) a.spec.raw.size = Index3{a.size[0], a.size[1], a.size[2]};
  if (!a.type.empty()) a.spec.raw.type = parse_sample_type(a.type);
  a.spec.raw.byte_order = a.endian == "big" ? std::endian::big : std::endian::little;
  const auto source = open_volume(a.spec);
  write_samples(*source, a.out);
  check_boxes(*source, a.out);
  write_whole_file(a.out + ".json", as_bytes(facts_of(source->info()).dump(1) + "\n"),
                   Durability::rename_only);
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("Writes what our readers make of a file.");
  Arguments arguments;
  declare(app, arguments);
  CLI11_PARSE(app, argc, argv);
  if (arguments.formats) {
    for (const VolumeReader& reader : volume_readers()) std::puts(reader.name.c_str());
    return 0;
  }
  dump(arguments);
  return 0;
} catch (const Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return error.exit_code();
}
