#include "storage/meshes/mesh_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <system_error>

#include "storage/meshes/mesh_formats.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

using Parser = void (*)(MeshStream&, MeshOutput&);

// Null where it is no known format.
Parser parser_of(std::string_view format) {
  if (format == "stl") return parse_stl;
  if (format == "off") return parse_off;
  if (format == "obj") return parse_obj;
  if (format == "ply") return parse_ply;
  return nullptr;
}

Parser parser_by_name(const std::filesystem::path& path) {
  const std::string extension = lower(path.extension().string());
  return extension.empty() ? nullptr : parser_of(std::string_view(extension).substr(1));
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

// Triangles are counted in 32 bits, and several times in the lists they stand in.
constexpr std::uint64_t most_triangles = std::uint64_t{1} << 29;

class MeshInMemory final : public MeshSink {
 public:
  MeshInMemory(const std::filesystem::path& path, TriangleMesh& mesh)
      : name_(path.string()), mesh_(mesh) {}

  void vertex(Vec3 place) override {
    if (mesh_.vertices.size() > 3 * most_triangles)
      throw FormatError(fmt::format("{}: more than {} vertices", name_, 3 * most_triangles));
    mesh_.vertices.push_back(place);
  }
  void triangle(const std::array<std::uint64_t, 3>& corners) override {
    if (mesh_.triangles.size() == most_triangles)
      throw FormatError(fmt::format("{}: more than {} triangles", name_, most_triangles));
    std::array<std::uint32_t, 3>& triangle = mesh_.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) triangle[i] = static_cast<std::uint32_t>(corners[i]);
  }
  void facet(const std::array<Vec3, 3>& corners) override {
    const std::uint64_t first = mesh_.vertices.size();
    for (const Vec3& corner : corners) vertex(corner);
    triangle({first, first + 1, first + 2});
  }

 private:
  std::string name_;
  TriangleMesh& mesh_;
};

}  // namespace

std::span<const std::byte> MeshStream::peek(std::size_t count) {
  if (next_ + count > held_.size()) fill(count);
  return std::span(held_).subspan(next_, std::min(count, held_.size() - next_));
}

void MeshStream::read(std::uint64_t at, std::span<std::byte> out) const {
  if (file_)
    file_->read(at, out);
  else
    std::ranges::copy(bytes_.subspan(at, out.size()), out.begin());
}

// Makes at least `count` bytes of the rest lie in one piece, where there are as many.
void MeshStream::fill(std::size_t count) {
  constexpr std::size_t piece = std::size_t{1} << 20;
  held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(next_));
  next_ = 0;
  while (held_.size() < count && read_ < size_) {
    if (between_) between_();
    const std::size_t begin = held_.size();
    held_.resize(begin + std::min<std::uint64_t>(piece, size_ - read_));
    const auto part = std::span(held_).subspan(begin);
    read(read_, part);
    hash_.update(part);
    read_ += part.size();
  }
}

std::optional<std::string_view> MeshStream::line() {
  constexpr std::size_t longest = std::size_t{4} << 20;
  for (std::size_t looked_at = 0;;) {
    const char* const begin = reinterpret_cast<const char*>(held_.data()) + next_;
    const std::string_view held{begin, held_.size() - next_};
    const std::size_t end = held.find('\n', looked_at);
    if (end != held.npos) {
      next_ += end + 1;
      return held.substr(0, end);
    }
    if (read_ == size_) {
      if (held.empty()) return std::nullopt;
      next_ = held_.size();
      return held;
    }
    if (held.size() > longest)
      fail(fmt::format("expected lines, found one of more than {} bytes", longest));
    looked_at = held.size();
    fill(held.size() + 1);
  }
}

bool MeshStream::holds_zero() const {
  std::vector<std::byte> piece;
  for (std::uint64_t at = 0; at < size_; at += piece.size()) {
    if (between_) between_();
    piece.resize(std::min<std::uint64_t>(std::uint64_t{1} << 20, size_ - at));
    read(at, piece);
    if (std::ranges::find(piece, std::byte{}) != piece.end()) return true;
  }
  return false;
}

Hash128 MeshStream::finish() {
  while (read_ < size_) {
    next_ = held_.size();
    fill(1);
  }
  return hash_.finish();
}

void MeshOutput::check(Vec3 place, std::uint64_t vertex) const {
  for (int a = 0; a < 3; ++a)
    if (!std::isfinite(place[a]))
      file_.fail(
          fmt::format("vertex {} has a coordinate {}; expected finite numbers", vertex, place[a]));
}

void MeshOutput::vertex(Vec3 place) {
  check(place, vertices_++);
  sink_.vertex(place);
}

void MeshOutput::facet(const std::array<Vec3, 3>& corners) {
  for (const Vec3& corner : corners) check(corner, vertices_++);
  sink_.facet(corners);
}

bool MeshOutput::corner(std::int64_t vertex) {
  if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertices_) return false;
  const auto corner = static_cast<std::uint64_t>(vertex);
  if (corners_ == 0) first_ = corner;
  if (corners_ >= 2) sink_.triangle({first_, last_, corner});
  last_ = corner;
  ++corners_;
  return true;
}

bool MeshLines::next() {
  words_.clear();
  while (words_.empty()) {
    const auto found = file_.line();
    if (!found) return false;
    ++line_;
    std::string_view line = *found;
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

bool is_mesh_name(const std::filesystem::path& path) {
  return parser_by_name(path) != nullptr;
}

MeshFacts read_mesh_file(const std::filesystem::path& path, MeshSink& sink,
                         const std::function<void()>& between) {
  const Parser parse = parser_for(path);
  check_is_there(path);
  MeshStream file(path, between);
  MeshOutput out(file, sink);
  parse(file, out);
  return {file.finish(), lower(path.extension().string()).substr(1), file.state()};
}

void read_mesh_bytes(std::span<const std::byte> bytes, const std::string& format,
                     const std::string& where, MeshSink& sink) {
  const std::function<void()> between;
  MeshStream file(bytes, where, between);
  MeshOutput out(file, sink);
  parser_of(format)(file, out);
}

MeshFile read_mesh_file(const std::filesystem::path& path) {
  MeshFile result;
  MeshInMemory sink(path, result.mesh);
  const MeshFacts facts = read_mesh_file(path, sink);
  result.content = facts.content;
  result.format = facts.format;
  weld(result.mesh);
  if (result.mesh.triangles.empty())
    throw FormatError(fmt::format("{}: no triangles", path.string()));
  return result;
}

}  // namespace voxweld
