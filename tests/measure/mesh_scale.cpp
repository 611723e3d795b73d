// Writes a closed mesh of any number of triangles, a dented ball, a row at a time:
//   mesh_scale FILE TRIANGLES [SHUFFLED]
// as .stl (binary), .ply (binary), .off or .obj. Shuffled: faces come in no order (.ply, .off,
// .obj), which is the worst for whoever looks up their corners.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <numbers>
#include <string>

#include "storage/types/box.h"

namespace voxweld {
namespace {

// Rings of `sectors` vertices between two poles. Triangles are made by number.
struct Ball {
  std::uint64_t rings, sectors;

  std::uint64_t vertices() const { return rings * sectors + 2; }
  std::uint64_t triangles() const { return 2 * rings * sectors; }
  Vec3 vertex(std::uint64_t number) const {
    Vec3 n{0, 0, number == rings * sectors ? 1.0 : -1.0};
    if (number < rings * sectors) {
      const double down = std::numbers::pi * (static_cast<double>(number / sectors) + 1) /
                          (static_cast<double>(rings) + 1);
      const double around = 2 * std::numbers::pi * static_cast<double>(number % sectors) /
                            static_cast<double>(sectors);
      n = {std::sin(down) * std::cos(around), std::sin(down) * std::sin(around), std::cos(down)};
    }
    return n * (20 * (1 + 0.3 * std::sin(5 * n.x) * std::cos(4 * n.y + n.z)));
  }
  std::array<std::uint64_t, 3> triangle(std::uint64_t number) const {
    const std::uint64_t band = number / sectors, i = number % sectors, j = (i + 1) % sectors;
    const std::uint64_t pole = rings * sectors;
    if (band == 0) return {pole, i, j};
    if (band == 2 * rings - 1) return {pole + 1, pole - sectors + j, pole - sectors + i};
    const std::uint64_t upper = (band - 1) / 2 * sectors, lower = upper + sectors;
    if (band % 2 == 1) return {upper + i, lower + i, upper + j};
    return {upper + j, lower + i, lower + j};
  }
};

template <class T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void put_floats(std::string& out, Vec3 place) {
  for (int a = 0; a < 3; ++a) put(out, static_cast<float>(place[a]));
}

class Writer {
 public:
  Writer(const std::string& path, const Ball& ball, bool shuffled)
      : out_(path, std::ios::binary),
        ball_(ball),
        shuffled_(shuffled),
        format_(path.substr(path.size() - 3)) {}

  bool write() {
    begin();
    if (format_ != "stl")
      for (std::uint64_t i = 0; i < ball_.vertices(); ++i) vertex(i);
    // Odd and prime: of no number of triangles a divisor that matters, so every face comes once.
    constexpr std::uint64_t stride = 1'000'000'007;
    const std::uint64_t count = ball_.triangles();
    for (std::uint64_t i = 0; i < count; ++i)
      face(shuffled_
               ? static_cast<std::uint64_t>(static_cast<unsigned __int128>(i) * stride % count)
               : i);
    flush();
    return out_.good();
  }

 private:
  void begin() {
    if (format_ == "stl") {
      text_.assign(80, ' ');
      put(text_, static_cast<std::uint32_t>(ball_.triangles()));
    } else if (format_ == "off") {
      text_ = fmt::format("OFF\n{} {} 0\n", ball_.vertices(), ball_.triangles());
    } else if (format_ == "ply") {
      text_ = fmt::format(
          "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n"
          "property float y\nproperty float z\nelement face {}\n"
          "property list uchar uint vertex_indices\nend_header\n",
          ball_.vertices(), ball_.triangles());
    }
  }
  void vertex(std::uint64_t number) {
    const Vec3 v = ball_.vertex(number);
    if (format_ == "ply")
      put_floats(text_, v);
    else
      text_ += fmt::format("{}{} {} {}\n", format_ == "obj" ? "v " : "", static_cast<float>(v.x),
                           static_cast<float>(v.y), static_cast<float>(v.z));
    flush_if_full();
  }
  void face(std::uint64_t number) {
    const auto t = ball_.triangle(number);
    if (format_ == "stl") {
      put_floats(text_, {});
      for (const std::uint64_t corner : t) put_floats(text_, ball_.vertex(corner));
      put(text_, std::uint16_t{0});
    } else if (format_ == "ply") {
      text_ += '\3';
      for (const std::uint64_t corner : t) put(text_, static_cast<std::uint32_t>(corner));
    } else if (format_ == "off") {
      text_ += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    } else {
      text_ += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    flush_if_full();
  }
  void flush_if_full() {
    if (text_.size() > (std::size_t{1} << 20)) flush();
  }
  void flush() {
    out_ << text_;
    text_.clear();
  }

  std::ofstream out_;
  const Ball ball_;
  const bool shuffled_;
  const std::string format_;
  std::string text_;
};

}  // namespace
}  // namespace voxweld

int main(int argc, char** argv) {
  if (argc < 3 || std::strlen(argv[1]) < 4) {
    fmt::print(stderr, "usage: mesh_scale FILE TRIANGLES [shuffled]\n");
    return 2;
  }
  const double triangles = std::max(12.0, std::stod(argv[2]));
  const auto rings = static_cast<std::uint64_t>(std::sqrt(triangles / 4));
  const voxweld::Ball ball{rings, 2 * rings};
  if (!voxweld::Writer(argv[1], ball, argc > 3).write()) {
    fmt::print(stderr, "{}: cannot be written\n", argv[1]);
    return 1;
  }
  fmt::print("{}: {} vertices, {} triangles\n", argv[1], ball.vertices(), ball.triangles());
  return 0;
}
