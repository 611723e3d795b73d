#include "tests/chaos/inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "tests/support/deflated.h"

namespace voxweld::testing {
namespace {

constexpr int side = 40;

// f(x, y, z) from the middle of the volume, x fastest.
template <class F>
std::string samples_of(F&& f) {
  std::string samples;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        samples.push_back(static_cast<char>(static_cast<unsigned char>(
            std::clamp(std::round(f(x - 19.5, y - 19.5, z - 19.5)), 0.0, 255.0))));
  return samples;
}

// A ball with waves on it.
struct Ball {
  double radius, waves, height;
  Ball() : radius(14), waves(0.3), height(2) {}
  explicit Ball(Random& random)
      : radius(10 + static_cast<double>(pick(random, 7))),
        waves(0.2 + 0.1 * static_cast<double>(pick(random, 4))),
        height(static_cast<double>(pick(random, 3))) {}
  double inside(double x, double y, double z) const {
    const double wave = height * std::sin(waves * x) * std::cos(waves * y + z * waves);
    return radius + wave - std::sqrt(x * x + y * y + z * z);
  }
};

std::string nrrd(const std::string& samples, bool gzip) {
  std::string file = fmt::format(
      "NRRD0004\ntype: uint8\ndimension: 3\nsizes: {0} {0} {0}\nspacings: 1 1 1\nencoding: {1}\n\n",
      side, gzip ? "gzip" : "raw");
  if (!gzip) return file + samples;
  const auto packed = deflated(std::as_bytes(std::span(samples)), Wrapper::gzip);
  return file.append(reinterpret_cast<const char*>(packed.data()), packed.size());
}

// Four labels that meet in the middle, in nothing.
std::string labels(const Ball& ball, double tilt) {
  return samples_of([&](double x, double y, double z) {
    if (ball.inside(x, y, z) < 0) return 0.0;
    return 1.0 + (x + tilt * y > 0 ? 1 : 0) + (z - tilt * x > 2 ? 2 : 0);
  });
}

// The ball as triangles, by rings.
std::string off(const Ball& ball) {
  constexpr int rings = 12, around = 20;
  std::string text =
      fmt::format("OFF\n{} {} 0\n", (rings - 1) * around + 2, 2 * around * (rings - 1));
  const auto vertex = [&](int ring, int i) {
    const double latitude = std::numbers::pi * ring / rings;
    const double longitude = 2 * std::numbers::pi * i / around;
    const double r = ball.radius + ball.height * std::sin(5 * longitude) * std::sin(latitude);
    text += fmt::format("{:.6f} {:.6f} {:.6f}\n", r * std::sin(latitude) * std::cos(longitude),
                        r * std::sin(latitude) * std::sin(longitude), r * std::cos(latitude));
  };
  vertex(0, 0);
  for (int ring = 1; ring < rings; ++ring)
    for (int i = 0; i < around; ++i) vertex(ring, i);
  vertex(rings, 0);
  const int last = (rings - 1) * around + 1;
  const auto at = [&](int ring, int i) { return 1 + (ring - 1) * around + i % around; };
  for (int i = 0; i < around; ++i) {
    text += fmt::format("3 0 {} {}\n3 {} {} {}\n", at(1, i), at(1, i + 1), last,
                        at(rings - 1, i + 1), at(rings - 1, i));
    for (int ring = 1; ring < rings - 1; ++ring)
      text += fmt::format("3 {0} {1} {2}\n3 {0} {2} {3}\n", at(ring, i), at(ring + 1, i),
                          at(ring + 1, i + 1), at(ring, i + 1));
  }
  return text;
}

std::string values(const Ball& ball) {
  return samples_of([&](double x, double y, double z) { return 128 + 12 * ball.inside(x, y, z); });
}

// Which labels are one material, by chance.
std::string label_map(Random& random) {
  std::string text = "label,name,material,color\n";
  for (int label = 1; label <= 4; ++label)
    text += fmt::format("{},piece {},{},#{:02x}80ff\n", label, pick(random, 3), 1 + pick(random, 4),
                        pick(random, 256));
  return text;
}

constexpr std::size_t half_the_samples = std::size_t{side} * side * side / 2;

std::vector<Variant> with_layout(std::vector<Variant> variants) {
  for (Variant& variant : variants)
    variant.input =
        fmt::format("format = \"raw\"\ntype = \"uint8\"\nsize = [{0}, {0}, {0}]\n", side);
  return variants;
}

const std::string box_away =
    "[[edit]]\nop = \"subtract\"\nshape = \"box\"\ncenter = [19, 19, 19]\nsize = [8, 9, 60]\n";
const std::string ball_away =
    "[[edit]]\nop = \"subtract\"\nshape = \"sphere\"\ncenter = [3, 4, 5]\nradius = 6\n";

std::string solid_at(const std::string& op, const std::string& center) {
  return fmt::format("[[edit]]\nop = \"{}\"\nshape = \"mesh\"\npath = \"v.off\"\ncenter = {}\n", op,
                     center);
}

}  // namespace

const InputFiles& files_of(InputKind kind) {
  static const InputFiles raw = {"v.raw", "v.raw", {}};
  static const InputFiles nrrd = {"v.nrrd", "v.nrrd", {}};
  static const InputFiles mesh = {"v.off", "v.off", {}};
  static const InputFiles two_files = {
      "v.raw",
      "v.nhdr",
      {{"v.nhdr", fmt::format("NRRD0004\ntype: uint8\ndimension: 3\nsizes: {0} {0} {0}\nencoding: "
                              "raw\ndata file: LIST 3\nu.raw\nv.raw\n",
                              side)},
       {"u.raw", values(Ball()).substr(0, half_the_samples)}}};
  static const InputFiles map = {"v.csv", "u.raw", {{"u.raw", labels(Ball(), 0.3)}}};
  static const InputFiles solid = {"v.off", "u.raw", {{"u.raw", values(Ball())}}};
  switch (kind) {
    case InputKind::raw:
    case InputKind::labels:
      return raw;
    case InputKind::two_files:
      return two_files;
    case InputKind::label_map:
      return map;
    case InputKind::mesh:
      return mesh;
    case InputKind::solid:
      return solid;
    default:
      return nrrd;
  }
}

std::string random_input(InputKind kind, Random& random) {
  const Ball ball(random);
  switch (kind) {
    case InputKind::raw:
      return values(ball);
    case InputKind::two_files:
      return values(ball).substr(half_the_samples);
    case InputKind::labels:
      return labels(ball, 0.1 * static_cast<double>(pick(random, 8)));
    case InputKind::label_map:
      return label_map(random);
    case InputKind::mesh:
    case InputKind::solid:
      return off(ball);
    default:
      return nrrd(values(ball), kind == InputKind::nrrd_gzip);
  }
}

const std::vector<Variant>& variants_of(InputKind kind) {
  static const std::vector<Variant> of_values = {
      {"", "[surface]\nisovalue = 128\n[simplify]\ntolerance = 0.1\n"},
      {"", "[surface]\nisovalue = 100\n[simplify]\ntolerance = 0.1\n"},
      {"", "[surface]\nisovalue = 128\n[simplify]\ntolerance = 0.4\n"},
      {"", "[surface]\nisovalue = 128\ninside = \"below\"\n"},
      {"", "[surface]\nisovalue = 128\nborder = \"open\"\ninside = \"below\"\n"},
      {"", "[surface]\nisovalue = 128\n" + box_away}};
  static const std::vector<Variant> of_raw = with_layout(of_values);
  static const std::vector<Variant> of_maps = with_layout(
      {{"", "[labels]\nmode = \"each\"\nmap = \"v.csv\"\n"},
       {"", "[labels]\nmode = \"each\"\nmap = \"v.csv\"\nselect = [1, 2]\n"},
       {"", "[labels]\nmode = \"each\"\nmap = \"v.csv\"\n[simplify]\ntolerance = 0.3\n"},
       {"", "[labels]\nmode = \"shared\"\nmap = \"v.csv\"\n"},
       {"", "[labels]\nmode = \"shared\"\nmap = \"v.csv\"\nmin_voxels = 2000\n"},
       {"", "[labels]\nmode = \"shared\"\nmap = \"v.csv\"\n" + box_away}});
  static const std::vector<Variant> of_solids = with_layout(
      {{"", "[surface]\nisovalue = 128\n" + solid_at("subtract", "[19, 25, 19]")},
       {"", "[surface]\nisovalue = 128\n" + solid_at("add", "[19, 25, 19]")},
       {"", "[surface]\nisovalue = 128\n" + solid_at("subtract", "[12, 19, 19]")},
       {"", "[surface]\nisovalue = 100\n" + solid_at("intersect", "[19, 25, 19]")},
       {"", "[surface]\nisovalue = 128\n" + solid_at("subtract", "[19, 25, 19]") + box_away},
       {"", "[surface]\nisovalue = 128\n[simplify]\ntolerance = 0.4\n" +
                solid_at("add", "[12, 19, 19]")}});
  static const std::vector<Variant> of_labels =
      with_layout({{"", "[labels]\nmode = \"each\"\n"},
                   {"", "[labels]\nmode = \"each\"\nselect = [1, 4]\n"},
                   {"", "[labels]\nmode = \"shared\"\n"},
                   {"", "[labels]\nmode = \"shared\"\n[simplify]\ntolerance = 0.4\n"},
                   {"", "[labels]\nmode = \"each\"\n" + box_away},
                   {"", "[labels]\nmode = \"shared\"\n" + box_away}});
  static const std::vector<Variant> of_meshes = {
      {"resolution = 30\n", ""},
      {"resolution = 36\n", ""},
      {"resolution = 30\n", "[simplify]\ntolerance = 0.4\n"},
      {"cell = 0.8\n", ""},
      {"resolution = 30\n", ball_away},
      {"resolution = 30\nmargin = 3\n", ball_away}};
  switch (kind) {
    case InputKind::raw:
      return of_raw;
    case InputKind::labels:
      return of_labels;
    case InputKind::label_map:
      return of_maps;
    case InputKind::solid:
      return of_solids;
    case InputKind::mesh:
      return of_meshes;
    default:
      return of_values;
  }
}

}  // namespace voxweld::testing
