// What the parsers of mesh files share; for mesh_file.cpp.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "storage/meshes/mesh_file.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {

// The bytes of a file, or of what was one, from the first to the last, hashed on the way, and the name
// its messages begin with. Memory: 2 MiB, and as much again for the longest line.
class MeshStream {
 public:
  MeshStream(const std::filesystem::path& path, const std::function<void()>& between)
      : file_(std::in_place, path), name_(file_->path()), size_(file_->size()), between_(between) {}
  MeshStream(std::span<const std::byte> bytes, const std::string& name,
             const std::function<void()>& between)
      : bytes_(bytes), name_(name), size_(bytes.size()), between_(between) {}

  std::uint64_t size() const { return size_; }
  const FileState& state() const { return file_->state(); }  // of files
  [[noreturn]] void fail(const std::string& problem) const {
    throw FormatError(fmt::format("{}: {}", name_, problem));
  }

  // Views are good until the next call.
  // The next `count` bytes, or those that are left; they stay.
  std::span<const std::byte> peek(std::size_t count);
  // The same, and they are taken.
  std::span<const std::byte> take(std::size_t count) {
    if (next_ + count > held_.size()) fill(count);
    const auto bytes = std::span(held_).subspan(next_, std::min(count, held_.size() - next_));
    next_ += bytes.size();
    return bytes;
  }
  // The next line, without its end; nothing after the last.
  std::optional<std::string_view> line();
  // Whether any of the file's bytes is 0; a pass of its own.
  bool holds_zero() const;

  // Of all the file's bytes, those not taken included.
  Hash128 finish();

 private:
  void fill(std::size_t count);
  void read(std::uint64_t at, std::span<std::byte> out) const;

  std::optional<ReadFile> file_;
  std::span<const std::byte> bytes_;  // where there is no file
  std::string name_;
  std::uint64_t size_;
  const std::function<void()>& between_;
  StreamHasher hash_;
  std::vector<std::byte> held_;
  std::size_t next_ = 0;    // in held_
  std::uint64_t read_ = 0;  // bytes of the file
};

// Checks places and counts vertices on their way to the sink; polygons become fans around their
// first corner. Mod 2, which is how insides are told, the fan of a flat polygon covers it, be it
// convex or not.
class MeshOutput {
 public:
  MeshOutput(const MeshStream& file, MeshSink& sink) : file_(file), sink_(sink) {}

  std::uint64_t vertices() const { return vertices_; }
  void vertex(Vec3 place);
  void facet(const std::array<Vec3, 3>& corners);

  void begin_polygon() { corners_ = 0; }
  // False when there is no such vertex (yet).
  bool corner(std::int64_t vertex);
  void labels(double inside, double outside) { sink_.labels(inside, outside); }

 private:
  void check(Vec3 place, std::uint64_t vertex) const;

  const MeshStream& file_;
  MeshSink& sink_;
  std::uint64_t vertices_ = 0, corners_ = 0;
  std::uint64_t first_ = 0, last_ = 0;  // corners of the polygon at hand
};

// Each takes what its format's specification allows.
void parse_stl(MeshStream& file, MeshOutput& out);
void parse_off(MeshStream& file, MeshOutput& out);
void parse_obj(MeshStream& file, MeshOutput& out);
void parse_ply(MeshStream& file, MeshOutput& out);

// The lines of a text that are not blank, without their comments, as words.
class MeshLines {
 public:
  MeshLines(MeshStream& file, std::string_view comment) : file_(file), comment_(comment) {}

  bool next();  // false at the end
  // Of the line at hand: good until the next one.
  const std::vector<std::string_view>& words() const { return words_; }
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
  MeshStream& file_;
  std::string_view comment_;
  std::uint64_t line_ = 0;
  std::vector<std::string_view> words_;
};

}  // namespace voxweld
