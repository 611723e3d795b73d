// What the parsers of mesh files share; for mesh_file.cpp.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "storage/support/error.h"
#include "storage/types/triangle_mesh.h"

namespace voxweld {

// A file's bytes and the name its messages begin with.
struct MeshBytes {
  const std::string& path;
  std::span<const std::byte> bytes;

  std::string_view text() const {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  [[noreturn]] void fail(const std::string& problem) const {
    throw FormatError(fmt::format("{}: {}", path, problem));
  }
};

// Triangles are counted in 32 bits, and several times in the lists they stand in.
inline constexpr std::uint64_t most_mesh_triangles = std::uint64_t{1} << 29;

// Each takes what its format's specification allows and fills in vertices and triangles as they
// stand in the file, its polygons as fans.
TriangleMesh parse_stl(const MeshBytes& file);
TriangleMesh parse_off(const MeshBytes& file);
TriangleMesh parse_obj(const MeshBytes& file);
TriangleMesh parse_ply(const MeshBytes& file);

// The lines of a text that are not blank, without their comments, as words.
class MeshLines {
 public:
  MeshLines(const MeshBytes& file, std::string_view comment) : file_(file), comment_(comment) {}

  bool next();  // false at the end
  const std::vector<std::string_view>& words() const { return words_; }
  std::size_t end() const { return at_; }  // of the line, in bytes from the file's start
  [[noreturn]] void fail(const std::string& problem) const {
    file_.fail(fmt::format("line {}: {}", line_, problem));
  }

  // FormatError where the word is not there or is no number; NaN and infinity are.
  double number(std::size_t word) const;
  // Three numbers from word `first` on.
  Vec3 place(std::size_t first) const;
  // FormatError where the word is not there or is no whole number.
  std::int64_t whole(std::size_t word) const;

 private:
  const MeshBytes& file_;
  std::string_view comment_;
  std::size_t at_ = 0, line_ = 0;
  std::vector<std::string_view> words_;
};

// Appends the polygon as a fan around its first corner. Mod 2, which is how insides are told, the
// fan of a flat polygon covers it, be it convex or not.
class PolygonFans {
 public:
  explicit PolygonFans(TriangleMesh& mesh) : mesh_(mesh) {}
  void begin() { corners_.clear(); }
  // False when there is no such vertex (yet).
  bool corner(std::int64_t vertex);
  void end(const MeshBytes& file);

 private:
  TriangleMesh& mesh_;
  std::vector<std::uint32_t> corners_;
};

}  // namespace voxweld
