#include "storage/readers/mesh_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <system_error>

#include "storage/readers/mesh_formats.h"
#include "storage/readers/text_fields.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

using Parser = TriangleMesh (*)(const MeshBytes&);

// Null where the name is of no known format.
Parser parser_by_name(const std::filesystem::path& path) {
  const std::string extension = lower(path.extension().string());
  if (extension == ".stl") return parse_stl;
  if (extension == ".off") return parse_off;
  if (extension == ".obj") return parse_obj;
  if (extension == ".ply") return parse_ply;
  return nullptr;
}

Parser parser_for(const std::filesystem::path& path) {
  if (const Parser parser = parser_by_name(path); parser != nullptr) return parser;
  throw InputError(
      fmt::format("{}: expected a mesh in a file named .stl, .off, .obj or .ply", path.string()));
}

void check_is_there(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    throw InputError(path.string() + ": no such mesh file; check the path");
  if (!std::filesystem::is_regular_file(status))
    throw InputError(path.string() + ": expected a mesh file, found a directory or device");
}

void check_finite(const MeshBytes& file, const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    for (int a = 0; a < 3; ++a)
      if (!std::isfinite(mesh.vertices[i][a]))
        file.fail(fmt::format("vertex {} has a coordinate {}; expected finite numbers", i,
                              mesh.vertices[i][a]));
}

bool before(Vec3 a, Vec3 b) {
  for (int i = 0; i < 3; ++i)
    if (a[i] != b[i]) return a[i] < b[i];
  return false;
}

// Vertices at equal places become one, in order of place; those of no triangle stay.
void weld(TriangleMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return before(mesh.vertices[a], mesh.vertices[b]);
  });
  std::vector<std::uint32_t> becomes(order.size());
  std::vector<Vec3> welded;
  for (const std::uint32_t i : order) {
    // 0 is written one way.
    const Vec3 place = mesh.vertices[i] + Vec3{};
    if (welded.empty() || before(welded.back(), place)) welded.push_back(place);
    becomes[i] = static_cast<std::uint32_t>(welded.size() - 1);
  }
  mesh.vertices = std::move(welded);
  for (auto& triangle : mesh.triangles)
    for (std::uint32_t& corner : triangle) corner = becomes[corner];
  std::erase_if(mesh.triangles,
                [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

}  // namespace

bool MeshLines::next() {
  const std::string_view text = file_.text();
  words_.clear();
  while (words_.empty()) {
    if (at_ >= text.size()) return false;
    const std::size_t stop = std::min(text.find('\n', at_), text.size());
    std::string_view line = text.substr(at_, stop - at_);
    at_ = stop + 1;
    ++line_;
    if (!comment_.empty()) line = line.substr(0, line.find(comment_));
    constexpr std::string_view space = " \t\r\f\v";
    for (std::size_t i = line.find_first_not_of(space); i < line.size();) {
      const std::size_t end = std::min(line.find_first_of(space, i), line.size());
      words_.push_back(line.substr(i, end - i));
      i = line.find_first_not_of(space, end);
    }
  }
  return true;
}

double MeshLines::number(std::size_t word) const {
  if (word >= words_.size())
    fail(fmt::format("expected a number as word {}, found the line's end", word + 1));
  std::string_view text = words_[word];
  if (text.starts_with('+')) text.remove_prefix(1);
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  // What is too small for a double is as good as 0.
  const bool tiny = error == std::errc::result_out_of_range && number == 0;
  if ((error != std::errc{} && !tiny) || stop != end)
    fail(fmt::format("expected a number, found \"{}\"", words_[word].substr(0, 40)));
  return number;
}

Vec3 MeshLines::place(std::size_t first) const {
  return {number(first), number(first + 1), number(first + 2)};
}

std::int64_t MeshLines::whole(std::size_t word) const {
  if (word >= words_.size())
    fail(fmt::format("expected a whole number as word {}, found the line's end", word + 1));
  const auto number = parse_integer(words_[word]);
  if (!number) fail(fmt::format("expected a whole number, found \"{}\"", words_[word]));
  return *number;
}

bool PolygonFans::corner(std::int64_t vertex) {
  if (vertex < 0 || vertex >= static_cast<std::int64_t>(mesh_.vertices.size())) return false;
  corners_.push_back(static_cast<std::uint32_t>(vertex));
  return true;
}

void PolygonFans::end(const MeshBytes& file) {
  for (std::size_t i = 2; i < corners_.size(); ++i)
    mesh_.triangles.push_back({corners_[0], corners_[i - 1], corners_[i]});
  if (mesh_.triangles.size() > most_mesh_triangles)
    file.fail(fmt::format("more than {} triangles", most_mesh_triangles));
}

bool is_mesh_name(const std::filesystem::path& path) {
  return parser_by_name(path) != nullptr;
}

MeshFile read_mesh_file(const std::filesystem::path& path) {
  const Parser parse = parser_for(path);
  check_is_there(path);
  const std::string name = path.string();
  const std::vector<std::byte> bytes = read_whole_file(path);
  const MeshBytes file{name, bytes};
  MeshFile result{parse(file), hash_bytes(bytes), lower(path.extension().string()).substr(1)};
  check_finite(file, result.mesh);
  weld(result.mesh);
  if (result.mesh.triangles.empty()) file.fail("no triangles");
  return result;
}

}  // namespace voxweld
