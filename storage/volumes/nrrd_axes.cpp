#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "storage/volumes/axes.h"
#include "storage/volumes/nrrd_header.h"

namespace voxweld {
namespace {

constexpr std::size_t max_dimension = 16;  // the format's own limit

// Kinds of axes along which samples lie in space; all others count components, times or items.
bool is_spatial_kind(const std::string& kind) {
  return kind == "domain" || kind == "space" || kind == "???" || kind == "none" || kind.empty();
}

struct AxisVector {
  bool none = false;
  Vec3 step;
};

// "(1,0,0)" with 3 numbers, or 4 where the world has a time axis too, whose number is left out.
Vec3 parse_vector(const HeaderFields& fields, const HeaderField& field, std::string_view text) {
  constexpr std::string_view wanted = "vectors like (1,0,0), one for each axis, or none";
  if (text.size() < 2 || text.front() != '(' || text.back() != ')') fields.reject(field, wanted);
  text = text.substr(1, text.size() - 2);
  std::vector<double> numbers;
  while (true) {
    const std::size_t comma = text.find(',');
    const auto number = parse_real(trim(text.substr(0, comma)));
    if (!number) fields.reject(field, wanted);
    numbers.push_back(*number);
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
  }
  if (numbers.size() != 3 && numbers.size() != 4)
    fields.fail(field, fmt::format("a world of {} dimensions is not supported: 3 are needed",
                                   numbers.size()));
  return {numbers[0], numbers[1], numbers[2]};
}

std::vector<AxisVector> parse_directions(const HeaderFields& fields, const HeaderField& field) {
  std::vector<AxisVector> vectors;
  std::string_view rest = trim(field.value);
  while (!rest.empty()) {
    const bool vector = rest.front() == '(';
    const std::size_t end = vector ? rest.find(')') : rest.find_first_of(" \t(");
    if (vector && end == std::string_view::npos) fields.reject(field, "closed parentheses");
    const std::string_view item = rest.substr(0, vector ? end + 1 : std::min(end, rest.size()));
    if (vector)
      vectors.push_back({false, parse_vector(fields, field, item)});
    else if (lower(item) == "none")
      vectors.push_back({true, {}});
    else
      fields.reject(field, "vectors like (1,0,0), one for each axis, or none");
    rest = trim(rest.substr(item.size()));
  }
  return vectors;
}

// "mm" "mm" "mm": quoted texts.
std::vector<std::string> parse_quoted(const HeaderFields& fields, const HeaderField& field) {
  std::vector<std::string> texts;
  std::string_view rest = trim(field.value);
  while (!rest.empty()) {
    const bool quoted = rest.front() == '"';
    const std::size_t end = quoted ? rest.find('"', 1) : rest.find_first_of(" \t");
    if (quoted && end == std::string_view::npos) fields.reject(field, "closed quotes");
    const std::size_t length = quoted ? end + 1 : std::min(end, rest.size());
    const std::string_view item = rest.substr(0, length);
    texts.emplace_back(quoted ? item.substr(1, item.size() - 2) : item);
    rest = trim(rest.substr(length));
  }
  return texts;
}

template <class T>
void require_count(const HeaderFields& fields, const HeaderField& field,
                   const std::vector<T>& values, std::size_t count) {
  if (values.size() != count)
    fields.reject(field, fmt::format("{} entries, as many as the dimension", count));
}

std::vector<std::string> axis_kinds(const HeaderFields& fields, std::size_t dimension) {
  const HeaderField* field = fields.find("kinds");
  if (field == nullptr) return std::vector<std::string>(dimension);
  std::vector<std::string> kinds = split_words(lower(field->value));
  require_count(fields, *field, kinds, dimension);
  return kinds;
}

std::vector<AxisVector> axis_directions(const HeaderFields& fields, std::size_t dimension) {
  const HeaderField* field = fields.find("space directions");
  if (field == nullptr) return {};
  std::vector<AxisVector> vectors = parse_directions(fields, *field);
  require_count(fields, *field, vectors, dimension);
  return vectors;
}

std::string common_unit(const HeaderFields& fields, const HeaderField& field,
                        std::vector<std::string> units) {
  for (std::string& unit : units) unit = canonical_unit(unit);
  if (units.empty()) return {};
  if (std::ranges::any_of(units, [&](const std::string& u) { return u != units.front(); }))
    fields.fail(field, "the axes have different units: convert them to one");
  return units.front() == "???" ? std::string() : units.front();
}

std::string space_name(const std::string& value) {
  const std::string name = lower(value);
  if (name == "right-anterior-superior" || name == "ras") return "RAS";
  if (name == "left-anterior-superior" || name == "las") return "LAS";
  if (name == "left-posterior-superior" || name == "lps") return "LPS";
  if (name.ends_with("-time")) return space_name(value.substr(0, value.size() - 5));
  return value;
}

void read_spacings(const HeaderFields& fields, const NrrdAxes& axes, VolumeInfo& info) {
  const HeaderField* field = fields.find("spacings");
  if (field == nullptr) {
    if (fields.find("axis mins") != nullptr || fields.find("axis maxs") != nullptr)
      info.warnings.push_back(fields.path() +
                              ": 'axis mins' and 'axis maxs' are ignored, the spacing is taken as "
                              "1: state the spacing if it is not");
    return;
  }
  const std::vector<double> spacings = fields.reals(*field, axes.sizes.size());
  std::array<Vec3, 3> steps{};
  for (std::size_t a = 0; a < 3; ++a) {
    steps[a][static_cast<int>(a)] =
        sound_spacing(spacings[axes.spatial[a]],
                      fmt::format("{}: axis {}", fields.where(*field), axes.spatial[a]), info);
  }
  set_axes(info, steps, fields.where(*field));
  const HeaderField* units = fields.find("units");
  if (units == nullptr) return;
  const std::vector<std::string> all = parse_quoted(fields, *units);
  require_count(fields, *units, all, axes.sizes.size());
  info.geometry.unit = common_unit(
      fields, *units, {all[axes.spatial[0]], all[axes.spatial[1]], all[axes.spatial[2]]});
}

}  // namespace

NrrdAxes read_nrrd_axes(const HeaderFields& fields) {
  const HeaderField& dimension = fields.require("dimension");
  const std::int64_t count = fields.integer(dimension);
  if (count < 1 || count > static_cast<std::int64_t>(max_dimension))
    fields.reject(dimension, fmt::format("a number from 1 to {}", max_dimension));
  if (count < 3)
    fields.fail(dimension,
                fmt::format("{}-D data are not a volume: 3 dimensions are needed", count));
  const auto n = static_cast<std::size_t>(count);
  NrrdAxes axes;
  const HeaderField& sizes = fields.require("sizes");
  axes.sizes = fields.integers(sizes, n);
  for (const std::int64_t size : axes.sizes)
    if (size < 1) fields.reject(sizes, fmt::format("{} positive sizes", n));

  const std::vector<std::string> kinds = axis_kinds(fields, n);
  const std::vector<AxisVector> vectors = axis_directions(fields, n);
  std::vector<bool> spatial(n, true);
  std::size_t left = n;
  for (std::size_t a = 0; a < n; ++a) {
    const bool outside = (!vectors.empty() && vectors[a].none) || !is_spatial_kind(kinds[a]);
    if (!outside) continue;
    if (axes.sizes[a] != 1)
      fields.fail(sizes,
                  fmt::format("axis {} (kind '{}') has {} entries a sample: vectors, colours "
                              "and series are not supported, extract one component first",
                              a, kinds[a].empty() ? "none" : kinds[a], axes.sizes[a]));
    spatial[a] = false;
    --left;
  }
  for (std::size_t a = n; a-- > 0 && left > 3;)
    if (spatial[a] && axes.sizes[a] == 1) {
      spatial[a] = false;
      --left;
    }
  if (left != 3)
    fields.fail(sizes, fmt::format("{} axes of space with more than one sample: a volume has 3, "
                                   "extract one volume first",
                                   left));
  for (std::size_t a = 0, at = 0; a < n; ++a)
    if (spatial[a]) axes.spatial[at++] = a;
  return axes;
}

void read_nrrd_geometry(const HeaderFields& fields, const NrrdAxes& axes, VolumeInfo& info) {
  VolumeGeometry& geometry = info.geometry;
  geometry.size = {axes.sizes[axes.spatial[0]], axes.sizes[axes.spatial[1]],
                   axes.sizes[axes.spatial[2]]};
  if (const HeaderField* space = fields.find("space")) {
    const bool is_text =
        std::ranges::all_of(space->value, [](char c) { return c >= ' ' && c <= '~'; });
    if (is_text)
      geometry.space = space_name(space->value);
    else
      info.warnings.push_back(fields.where(*space) + ": is not ASCII text and is ignored");
  }
  const std::vector<AxisVector> vectors = axis_directions(fields, axes.sizes.size());
  if (vectors.empty()) {
    read_spacings(fields, axes, info);
  } else {
    const HeaderField& field = fields.require("space directions");
    set_axes(info,
             {vectors[axes.spatial[0]].step, vectors[axes.spatial[1]].step,
              vectors[axes.spatial[2]].step},
             fields.where(field));
  }
  if (const HeaderField* origin = fields.find("space origin")) {
    const Vec3 at = parse_vector(fields, *origin, trim(origin->value));
    if (!std::isfinite(dot(at, at))) fields.reject(*origin, "three finite numbers");
    geometry.origin = at;
  }
  if (const HeaderField* units = fields.find("space units")) {
    std::vector<std::string> all = parse_quoted(fields, *units);
    if (all.size() == 4) all.pop_back();  // of time
    geometry.unit = common_unit(fields, *units, std::move(all));
  }
}

}  // namespace voxweld
