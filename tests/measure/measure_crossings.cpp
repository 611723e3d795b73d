// How far crossings and normals of lattice edges are from a phantom's true surface, near its creases
// and in smooth places, for each way to estimate them: of samples as they are, with noise, and of
// the blurred solid, as scanners see it.
// usage: measure_crossings KIND SIZE [NEAR]
// A crossing is near a crease where the field's gradient, up to NEAR voxels (0.6) away along each
// axis, turns by more than 25 degrees. Edges that noise makes cross, or cross no longer, are left
// out. "known" knows the noise, "auto" measures it, here of all samples. Positions are distances to
// the true surface, in voxels; normals are off in degrees.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "pipeline/phantom/fields.h"
#include "stages/build/edge_estimator.h"
#include "stages/ingest/noise_level.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

using Samples = std::vector<float>;

Vec3 place_of(Index3 s) {
  return {static_cast<double>(s.x), static_cast<double>(s.y), static_cast<double>(s.z)};
}
std::size_t number_of(Index3 s, Index3 size) {
  return static_cast<std::size_t>((s.z * size.y + s.y) * size.x + s.x);
}
double degrees_between(Vec3 a, Vec3 b) {
  return std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * 180 / std::numbers::pi;
}

Samples samples_of(const AnalyticField& field, Index3 size) {
  Samples samples(static_cast<std::size_t>(size.x * size.y * size.z));
  tbb::parallel_for(std::int64_t{0}, size.z, [&](std::int64_t z) {
    std::vector<double> slice(static_cast<std::size_t>(size.x * size.y));
    field.fill({{0, 0, z}, {size.x, size.y, z + 1}}, std::numeric_limits<double>::infinity(),
               slice.data());
    std::transform(slice.begin(), slice.end(), samples.begin() + z * size.x * size.y,
                   [](double value) { return static_cast<float>(value); });
  });
  return samples;
}

Samples with_noise(Samples samples, double deviation) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, deviation);
  for (float& value : samples)
    value = static_cast<float>(static_cast<double>(value) + normal(random));
  return samples;
}

Samples blurred_along(const Samples& samples, Index3 size, int axis,
                      std::span<const double> weights) {
  Samples blurred(samples.size());
  const auto reach = static_cast<std::int64_t>(weights.size() / 2);
  tbb::parallel_for(std::int64_t{0}, size.z, [&](std::int64_t z) {
    each_index(Index3{size.x, size.y, 1}, [&](Index3 in_slice) {
      const Index3 s{in_slice.x, in_slice.y, z};
      double sum = 0;
      for (std::int64_t k = -reach; k <= reach; ++k) {
        Index3 at = s;
        at[axis] = std::clamp<std::int64_t>(s[axis] + k, 0, size[axis] - 1);
        sum += weights[static_cast<std::size_t>(k + reach)] *
               static_cast<double>(samples[number_of(at, size)]);
      }
      blurred[number_of(s, size)] = static_cast<float>(sum);
    });
  });
  return blurred;
}

// How much of each voxel is outside, less a half, seen through a Gaussian.
Samples with_blur(Samples samples, Index3 size, double deviation) {
  for (float& value : samples) value = std::clamp(value, -0.5f, 0.5f);
  std::vector<double> weights;
  double sum = 0;
  for (int k = -5; k <= 5; ++k) {
    weights.push_back(std::exp(-k * k / (2 * deviation * deviation)));
    sum += weights.back();
  }
  for (double& weight : weights) weight /= sum;
  for (int axis = 0; axis < 3; ++axis) samples = blurred_along(samples, size, axis, weights);
  return samples;
}

struct TrueEdge {
  int axis = 0;
  Index3 s;  // its low end
  bool low_inside = false;
  Vec3 normal;
  bool at_crease = false;
};

Vec3 unit_gradient(const AnalyticField& field, Vec3 p, double step) {
  Vec3 g;
  for (int a = 0; a < 3; ++a) {
    Vec3 below = p, above = p;
    below[a] -= step;
    above[a] += step;
    g[a] = field.at(above) - field.at(below);
  }
  return g * (1 / std::sqrt(dot(g, g)));
}

// By bisection.
Vec3 true_crossing(const AnalyticField& field, const TrueEdge& edge) {
  Vec3 low = place_of(edge.s), high = low;
  high[edge.axis] += 1;
  for (int i = 0; i < 45; ++i) {
    const Vec3 middle = (low + high) * 0.5;
    ((field.at(middle) <= 0) == edge.low_inside ? low : high) = middle;
  }
  return (low + high) * 0.5;
}

std::vector<TrueEdge> true_edges(const AnalyticField& field, const Samples& samples, Index3 size,
                                 double near) {
  constexpr double most_degrees = 25;
  std::vector<TrueEdge> edges;
  const auto inside = [&](Index3 s) { return samples[number_of(s, size)] <= 0; };
  each_index(size, [&](Index3 s) {
    for (int axis = 0; axis < 3; ++axis) {
      Index3 next = s;
      if (++next[axis] < size[axis] && inside(s) != inside(next))
        edges.push_back({axis, s, inside(s), {}, false});
    }
  });
  tbb::parallel_for(std::size_t{0}, edges.size(), [&](std::size_t i) {
    const Vec3 p = true_crossing(field, edges[i]);
    edges[i].normal = unit_gradient(field, p, 1e-7);
    each_index(splat(3), [&](Index3 k) {
      const Vec3 around = p + (place_of(k) - Vec3{1, 1, 1}) * near;
      if (degrees_between(unit_gradient(field, around, 1e-4), edges[i].normal) > most_degrees)
        edges[i].at_crease = true;
    });
  });
  return edges;
}

struct Deviation {
  bool known = false;
  double distance = 0, degrees = 0;
};

std::vector<Deviation> deviations(const AnalyticField& field, const Samples& samples, Index3 size,
                                  const std::vector<TrueEdge>& edges,
                                  const ContourParameters& parameters) {
  const HaloBlock block{SampleType::f32, size,
                        {{}, size},      reinterpret_cast<const std::byte*>(samples.data()),
                        size.x,          size.x * size.y};
  const EdgeEstimator<float> estimator(block, parameters);
  std::vector<Deviation> found(edges.size());
  tbb::parallel_for(std::size_t{0}, edges.size(), [&](std::size_t i) {
    const TrueEdge& edge = edges[i];
    Index3 next = edge.s;
    ++next[edge.axis];
    const bool low = samples[number_of(edge.s, size)] <= 0;
    if (low != edge.low_inside || low == (samples[number_of(next, size)] <= 0)) return;
    const HermiteEdge estimate = estimator.edge(edge.axis, edge.s, low);
    Vec3 p = place_of(edge.s), normal;
    p[edge.axis] += static_cast<double>(estimate.t);
    for (int a = 0; a < 3; ++a)
      normal[a] = static_cast<double>(estimate.normal[static_cast<std::size_t>(a)]);
    found[i] = {true, field.surface_distance(p), degrees_between(normal, edge.normal)};
  });
  return found;
}

void print_row(const char* samples, const char* method, bool at_crease,
               const std::vector<TrueEdge>& edges, const std::vector<Deviation>& found) {
  std::vector<double> distances;
  double sum = 0, degrees = 0;
  std::size_t over = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!found[i].known || edges[i].at_crease != at_crease) continue;
    distances.push_back(found[i].distance);
    sum += found[i].distance;
    degrees += found[i].degrees;
    over += found[i].degrees > 10 ? 1U : 0U;
  }
  if (distances.empty()) return;
  std::sort(distances.begin(), distances.end());
  const auto n = static_cast<double>(distances.size());
  fmt::print("{:9} {:8} {:7} {:8} {:9.4f} {:9.4f} {:9.3f} {:9.2f}\n", samples, method,
             at_crease ? "creases" : "smooth", distances.size(), sum / n,
             distances[distances.size() - 1 - distances.size() / 100], degrees / n,
             100 * static_cast<double>(over) / n);
}

struct Method {
  const char* name;
  Gradient gradient;
  double noise;
};

void measure(const char* name, const AnalyticField& field, const Samples& samples, Index3 size,
             const std::vector<TrueEdge>& edges, double noise) {
  NoiseMeter meter(SampleType::f32, Isovalue(0.0));
  meter.add(size, reinterpret_cast<const std::byte*>(samples.data()));
  const double measured = meter.level();
  fmt::print("{}: noise of {:.4f} measured\n", name, measured);
  const Method methods[] = {{"central", Gradient::central, 0},
                            {"eno", Gradient::eno, 0},
                            {"subcell", Gradient::subcell, 0},
                            {"known", Gradient::subcell, noise},
                            {"auto", Gradient::subcell, measured}};
  for (const bool at_crease : {true, false})
    for (const Method& method : methods) {
      ContourParameters parameters;
      parameters.surface.isovalue = 0;
      parameters.surface.inside = Inside::below;
      parameters.surface.gradient = method.gradient;
      parameters.surface.noise = method.noise;
      print_row(name, method.name, at_crease, edges,
                deviations(field, samples, size, edges, parameters));
    }
}

}  // namespace
}  // namespace voxweld

int main(int argc, char** argv) try {
  using namespace voxweld;
  if (argc < 3 || argc > 4) {
    fmt::print(stderr, "usage: measure_crossings KIND SIZE [NEAR]\n");
    return 2;
  }
  const auto field = make_analytic_field(parse_phantom_kind(argv[1]), std::atoll(argv[2]));
  const Index3 size = splat(std::atoll(argv[2]));
  const Samples clean = samples_of(*field, size);
  const auto edges = true_edges(*field, clean, size, argc > 3 ? std::atof(argv[3]) : 0.6);
  fmt::print("samples   method   near    crossings      mean       p99   degrees over10(%)\n");
  measure("clean", *field, clean, size, edges, 0);
  measure("noise .02", *field, with_noise(clean, 0.02), size, edges, 0.02);
  measure("noise .1", *field, with_noise(clean, 0.1), size, edges, 0.1);
  measure("blurred", *field, with_blur(clean, size, 0.8), size, edges, 0);
  return 0;
} catch (const voxweld::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return error.exit_code();
}
