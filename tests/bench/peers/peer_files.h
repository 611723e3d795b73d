// What the peers share: the volume they read, the mesh they write, and the line that they print.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace peers {

// As `voxweld phantom` writes it: an NRRD file with its samples in itself, whose comment says the
// isovalue. Material is below it. Labels have none.
struct Volume {
  std::array<int, 3> size{};  // x first
  std::string type;           // as NRRD names it: uint8, uint16, float; of labels uint32 too
  double isovalue = 0;
  std::vector<std::byte> samples;  // x fastest
};

struct Mesh {
  std::vector<std::array<float, 3>> vertices;  // in sample indices
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Of one program. meshing: from samples in memory to triangles in memory.
struct Seconds {
  double reading = 0, meshing = 0, writing = 0;
};

class Stopwatch {
 public:
  // Seconds since the last call, or since it was made.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> passed = now - start_;
    start_ = now;
    return passed.count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// std::runtime_error where it is no such file; the message names it and what is wrong.
Volume read_volume(const std::string& path);
// The same of labels, as numbers.
struct Labels {
  std::array<int, 3> size{};
  std::vector<std::uint32_t> samples;
};
Labels read_labels(const std::string& path);

// A binary .ply. std::runtime_error where it cannot be written.
void write_ply(const std::string& path, const Mesh& mesh);

// One JSON object, for run.sh.
void print_figures(const Seconds& seconds, std::size_t triangles, const std::string& library);

// Calls with_samples with a pointer to the samples, of their own type.
template <class F>
auto with_samples(Volume& volume, F&& f) {
  std::byte* data = volume.samples.data();
  if (volume.type == "uint8") return f(reinterpret_cast<std::uint8_t*>(data));
  if (volume.type == "uint16") return f(reinterpret_cast<std::uint16_t*>(data));
  if (volume.type == "float") return f(reinterpret_cast<float*>(data));
  throw std::runtime_error("samples of type " + volume.type + ": take uint8, uint16 or float");
}

// argv[at] as a number, or what is to be taken where it is not given.
double number_argument(int argc, char** argv, int at, double otherwise);

}  // namespace peers
