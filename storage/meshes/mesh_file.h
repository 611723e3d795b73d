// Triangle meshes from STL, OFF, OBJ and PLY files: read forwards, a piece at a time, to whoever
// wants them, or whole into memory.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "storage/support/file_io.h"
#include "storage/support/hash.h"
#include "storage/types/triangle_mesh.h"

namespace voxweld {

struct MeshFile {
  // Corners at equal places are one (STL writes each as often as it is used); polygons are cut into
  // fans; triangles that have a corner twice are gone. All else is as the file has it.
  TriangleMesh mesh;
  Hash128 content;     // of the file's bytes
  std::string format;  // "stl", "off", "obj" or "ply"
};

// What a file's vertices and triangles go to, in the order the file has them: as they are, nothing
// put together and nothing dropped.
class MeshSink {
 public:
  virtual ~MeshSink() = default;
  // Of formats that number their vertices, from 0 on. Finite.
  virtual void vertex(Vec3 place) = 0;
  // Precondition: all three were there before.
  virtual void triangle(const std::array<std::uint64_t, 3>& corners) = 0;
  // Of formats that do not. Finite.
  virtual void facet(const std::array<Vec3, 3>& corners) = 0;
  // After the triangles of a polygon: what a .ply has as `label` and `label_outside`, where it has both.
  virtual void labels(double /*inside*/, double /*outside*/) {}
};

// Whether the name ends as those of mesh files do.
bool is_mesh_name(const std::filesystem::path& path);

struct MeshFacts {
  Hash128 content;
  std::string format;
  FileState state;  // when it was opened
};

// The whole file to the sink, in a small constant of memory. The format goes by the name's
// extension; an .stl and a .ply may be text or binary. between: called every few megabytes, to
// stop.
// InputError: no such file, or a name of no known format. FormatError: damaged, or a coordinate
// that is not a finite number.
MeshFacts read_mesh_file(const std::filesystem::path& path, MeshSink& sink,
                         const std::function<void()>& between = {});

// The same of bytes that are in memory. format: as MeshFacts has it. where: what messages begin with.
// Precondition: the format is one of those of is_mesh_name.
void read_mesh_bytes(std::span<const std::byte> bytes, const std::string& format,
                     const std::string& where, MeshSink& sink);

// The same into memory; FormatError too where there are no triangles, or more than 2^29.
MeshFile read_mesh_file(const std::filesystem::path& path);

}  // namespace voxweld
