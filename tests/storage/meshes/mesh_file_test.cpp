// Mesh files of each format, right and wrong.
#include "storage/meshes/mesh_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/support/temp_directory.h"
#include "tests/support/triangle_meshes.h"

namespace voxweld {
namespace {

using ::testing::HasSubstr;

class MeshFileTest : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    const auto path = directory_ / name;
    write_whole_file(path, as_bytes(content), Durability::rename_only);
    return path;
  }
  TriangleMesh read(const std::string& name, const std::string& content) const {
    return read_mesh_file(write(name, content)).mesh;
  }
  std::string error_of(const std::string& name, const std::string& content) const {
    try {
      read(name, content);
    } catch (const Error& error) {
      EXPECT_EQ(error.exit_code(), 2);
      return error.what();
    }
    ADD_FAILURE() << "accepted: " << content;
    return {};
  }
  testing::TempDirectory directory_;
};

const TriangleMesh box = testing::box_mesh({-1, 0, 2}, {1.5, 0.25, 1e3});

template <class T>
std::string raw(T value, bool big = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string vertex_lines(const std::string& begin = {}) {
  std::string text;
  for (const Vec3& v : box.vertices) text += fmt::format("{}{} {} {}\n", begin, v.x, v.y, v.z);
  return text;
}

std::string face_lines(const std::string& begin, std::uint32_t first) {
  std::string text;
  for (const auto& t : box.triangles)
    text += fmt::format("{} {} {} {}\n", begin, t[0] + first, t[1] + first, t[2] + first);
  return text;
}

std::string off() {
  return "OFF\n# a box\n8 12 0\n\n" + vertex_lines() + face_lines("3", 0);
}

std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment a box\nelement vertex 8\nproperty float x\nproperty double y\n"
         "property float z\nproperty uchar red\nelement face 12\nproperty float quality\n"
         "property list uchar int vertex_indices\nend_header\n";
}

std::string binary_ply(bool big) {
  std::string bytes = ply_header(big ? "binary_big_endian" : "binary_little_endian");
  for (const Vec3& v : box.vertices)
    bytes += raw(static_cast<float>(v.x), big) + raw(v.y, big) + raw(static_cast<float>(v.z), big) +
             '\7';
  for (const auto& t : box.triangles) {
    bytes += raw(0.5F, big) + '\3';
    for (const std::uint32_t corner : t) bytes += raw(corner, big);
  }
  return bytes;
}

std::string binary_stl(const std::string& header = "solid, and binary all the same") {
  std::string bytes = header;
  bytes.resize(80, '\0');
  bytes += raw(static_cast<std::uint32_t>(box.triangles.size()));
  for (const auto& t : box.triangles) {
    bytes += std::string(12, '\0');
    for (const std::uint32_t corner : t)
      for (int a = 0; a < 3; ++a) bytes += raw(static_cast<float>(box.vertices[corner][a]));
    bytes += std::string(2, '\0');
  }
  return bytes;
}

std::string text_stl() {
  std::string text = "solid box\r\n";
  for (const auto& t : box.triangles) {
    text += "  facet normal 0 0 0\r\n    outer loop\r\n";
    for (const std::uint32_t corner : t) {
      const Vec3 v = box.vertices[corner];
      text += fmt::format("      vertex {} +{} {:e}\r\n", v.x, v.y, v.z);
    }
    text += "    endloop\r\n  endfacet\r\n";
  }
  return text + "endsolid box\r\n";
}

// Vertices come in order of place, so the box does whatever the order in the file.
void expect_box(const TriangleMesh& mesh) {
  EXPECT_EQ(mesh.vertices.size(), 8U);
  EXPECT_EQ(mesh.triangles.size(), 12U);
  EXPECT_NEAR(testing::volume_of(mesh), 2.5 * 0.25 * 998, 1e-9);
  EXPECT_EQ(mesh.vertices.front(), (Vec3{-1, 0, 2}));
  EXPECT_EQ(mesh.vertices.back(), (Vec3{1.5, 0.25, 1000}));
}

TEST_F(MeshFileTest, EveryFormatGivesTheBox) {
  expect_box(read("a.off", off()));
  expect_box(read("b.OFF", "COFF 8 12 18\n" + vertex_lines() + face_lines("3", 0)));
  expect_box(read("a.obj", "o box\n" + vertex_lines("v ") + "vn 0 0 1\n" + face_lines("f", 1)));
  expect_box(read("a.ply", binary_ply(false)));
  expect_box(read("b.ply", binary_ply(true)));
  std::string ascii = ply_header("ascii");
  for (const Vec3& v : box.vertices) ascii += fmt::format("{} {} {} 7\n", v.x, v.y, v.z);
  expect_box(read("c.ply", ascii + face_lines("0.5 3", 0)));
  expect_box(read("a.stl", binary_stl()));
  expect_box(read("b.stl", binary_stl() + "padding"));
  expect_box(read("c.stl", text_stl()));
}

TEST_F(MeshFileTest, PolygonsAndCountsFromTheEnd) {
  const std::string faces =
      "f 1//1 3//1 4//1 2//1\nf 5/2 6/2 8/2 7/2\nf -8 -7 -3 -4\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  expect_box(read("a.obj", vertex_lines("v ") + faces));
  expect_box(read("a.off", "OFF\n8 6 0\n" + vertex_lines() +
                               "4 0 2 3 1 255 0 0\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n"
                               "4 1 3 7 5\n"));
}

TEST_F(MeshFileTest, WeldsAndDropsWhatIsNoTriangle) {
  const TriangleMesh mesh = read("a.off",
                                 "OFF\n6 3 0\n0 0 0\n1 0 0\n0 1 0\n-0 0 0\n5 5 5\n1 0 0\n"
                                 "3 0 1 2\n3 3 5 2\n3 0 3 1\n");
  EXPECT_EQ(mesh.vertices.size(), 4U);
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_EQ(mesh.triangles[0], mesh.triangles[1]);
}

TEST_F(MeshFileTest, ContentIsOfTheBytes) {
  const Hash128 first = read_mesh_file(write("a.off", off())).content;
  EXPECT_EQ(read_mesh_file(write("b.off", off())).content, first);
  EXPECT_NE(read_mesh_file(write("a.off", off() + "\n")).content, first);
}

TEST_F(MeshFileTest, SaysWhatIsWrong) {
  EXPECT_THAT(error_of("a.step", ""), HasSubstr("a.step: expected a mesh in a file named .stl, "));
  EXPECT_THROW(read_mesh_file(directory_ / "none.stl"), InputError);
  EXPECT_THROW(read_mesh_file(directory_.path() / "."), InputError);
  EXPECT_THAT(error_of("a.off", "OFF\n0 0 0\n"), HasSubstr("a.off: no triangles"));
  EXPECT_THAT(error_of("a.off", "OFF\n3 1 0\n0 0 0\n1 0 x\n"),
              HasSubstr("a.off: line 4: expected a number, found \"x\""));
  EXPECT_THAT(error_of("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
              HasSubstr("line 6: vertex 3 of 3: there is none"));
  EXPECT_THAT(error_of("a.off", "OFF\n3 99999999999 0\n"), HasSubstr("more than a file of"));
  EXPECT_THAT(error_of("a.off", "OFF BINARY\n"), HasSubstr("expected a text beginning"));
  EXPECT_THAT(error_of("a.obj", "v 0 0 0\nf 1 2 3\n"), HasSubstr("line 2: face corner \"2\""));
  EXPECT_THAT(error_of("a.obj", "v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
              HasSubstr("vertex 0 has a coordinate nan; expected finite numbers"));
  EXPECT_THAT(error_of("a.ply", "solid"), HasSubstr("beginning with \"ply\""));
  EXPECT_THAT(error_of("a.ply",
                       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                       "property float y\nproperty float z\nend_header\n0 0 0\n"),
              HasSubstr("no faces with a list vertex_indices"));
  for (const char* count : {"-1", "nan", "1e+30"})
    EXPECT_THAT(
        error_of("a.ply", std::string("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                                      "property float y\nproperty float z\nelement face 1\n"
                                      "property list double int vertex_indices\nend_header\n"
                                      "0 0 0\n") +
                              count + " 0 0 0\n"),
        HasSubstr("a list vertex_indices of " + std::string(count)));
  EXPECT_THAT(error_of("a.stl", "solid x\nfacet\nouter loop\nvertex 0 0 0\nendloop\n"),
              HasSubstr("line 5: expected three vertices, found 1"));
}

// Files are read a piece at a time: numbers and lines lie across where pieces meet.
TEST_F(MeshFileTest, LongerThanAPiece) {
  const TriangleMesh ball = testing::dented_ball({3, 4, 5}, 7, 7);
  const auto count = std::pair(ball.vertices.size(), ball.triangles.size());
  std::string text = fmt::format("OFF\n{} {} 0\n", count.first, count.second);
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\n"
      "property double y\nproperty double z\nelement face {}\n"
      "property list uchar int vertex_index\nend_header\n",
      count.first, count.second);
  for (const Vec3& v : ball.vertices) {
    text += fmt::format("{} {} {}\n", v.x, v.y, v.z);
    bytes += raw(v.x) + raw(v.y) + raw(v.z);
  }
  for (const auto& t : ball.triangles) {
    text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    bytes += '\3' + raw(t[0]) + raw(t[1]) + raw(t[2]);
  }
  ASSERT_GT(std::min(text.size(), bytes.size()), std::size_t{3} << 19);
  const MeshFile off = read_mesh_file(write("a.off", text));
  const MeshFile ply = read_mesh_file(write("a.ply", bytes));
  EXPECT_EQ(off.mesh.triangles.size(), count.second);
  EXPECT_EQ(off.mesh.vertices, ply.mesh.vertices);
  EXPECT_EQ(off.mesh.triangles, ply.mesh.triangles);
  EXPECT_EQ(off.content, hash_bytes(as_bytes(text)));
  EXPECT_EQ(ply.content, hash_bytes(as_bytes(bytes)));
  EXPECT_THAT(error_of("a.off", text.substr(0, text.rfind(' '))),
              HasSubstr(fmt::format("line {}: expected a whole number as word 4",
                                    count.first + count.second + 2)));
  EXPECT_THAT(error_of("b.off", std::string(std::size_t{9} << 20, '1')),
              HasSubstr("expected lines, found one of more than"));
}

// Cut anywhere, a file is refused or read as what is left of it, and nothing else happens.
TEST_F(MeshFileTest, TruncatedFiles) {
  for (const auto& [name, whole] :
       {std::pair<std::string, std::string>{"a.stl", binary_stl("b")}, {"b.ply", binary_ply(true)}})
    for (std::size_t size = 0; size < whole.size(); ++size)
      EXPECT_NE(error_of(name, whole.substr(0, size)), "") << size;
  for (const auto& [name, whole] :
       {std::pair<std::string, std::string>{"a.off", off()}, {"c.stl", text_stl()}})
    for (std::size_t size = 0; size < whole.size(); size += 7) try {
        EXPECT_LE(read(name, whole.substr(0, size)).triangles.size(), 12U);
      } catch (const Error& error) {
        EXPECT_EQ(error.exit_code(), 2);
      }
}

}  // namespace
}  // namespace voxweld
