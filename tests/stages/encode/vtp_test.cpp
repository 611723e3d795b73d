#include "stages/encode/vtp.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <sstream>

#include "stages/encode/lattice_mesh.h"
#include "stages/encode/mesh_accumulator.h"
#include "stages/encode/mesh_measure.h"
#include "storage/support/error.h"
#include "storage/types/leaf_vertex.h"
#include "tests/stages/encode/pair_book.h"
#include "tests/support/by_python.h"
#include "tests/support/error_text.h"
#include "tests/support/temp_directory.h"

namespace voxweld {
namespace {

using testing::book;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing::with_pairs;

TileMesh vtp_torus() {
  return testing::make_torus({.around = 60, .across = 30}, testing::small_lattice());
}

std::vector<std::byte> vtp_of(const std::vector<TileMesh>& tiles) {
  const EachTile each_tile = [&](const auto& f) {
    for (const TileMesh& tile : tiles) f(tile);
  };
  std::vector<std::byte> file;
  stream_vtp(each_tile, totals_of(each_tile), [&](std::span<const std::byte> bytes) {
    file.insert(file.end(), bytes.begin(), bytes.end());
  });
  return file;
}

std::string head_of(const std::vector<std::byte>& file) {
  const std::string text(reinterpret_cast<const char*>(file.data()), file.size());
  return text.substr(0, text.find("<AppendedData"));
}

TEST(Vtp, IsReadAsItWasWritten) {
  const TileMesh mesh = vtp_torus();
  for (const int level : {3, 6}) {
    const auto file = vtp_of(testing::cut_into_tiles(mesh, level));
    const DecodedMesh read = decode_vtp(file, "file");
    EXPECT_EQ(digest(weld(read, mesh.lattice)),
              digest(LatticeMesh{mesh.positions, mesh.triangles}));
    EXPECT_EQ(read.positions.size(), mesh.positions.size());
    EXPECT_TRUE(read.pairs.empty());
    EXPECT_THAT(head_of(file), HasSubstr("<PointData Normals=\"Normals\">"));
    EXPECT_THAT(head_of(file), HasSubstr("type=\"Int32\" Name=\"connectivity\""));
  }
}

TEST(Vtp, DoesNotDependOnWhereTheMeshIsCut) {
  MeshAccumulator accumulator;
  for (const TileMesh& tile : testing::cut_into_tiles(vtp_torus(), 2)) accumulator.append(tile);
  const TileMesh in_order = accumulator.take();
  for (const int level : {3, 4, 6})
    EXPECT_EQ(vtp_of(testing::cut_into_tiles(in_order, level)), vtp_of({in_order}));
}

TEST(Vtp, HasTheLabelsOfTriangles) {
  for (const Material label :
       {Material{7}, Material{0x7fffffff}, Material{0x80000000}, (Material{1} << 63) - 1}) {
    TileMesh mesh = book(3, 6);
    mesh.pairs = {{0, exterior}, {1, label}, {2, 9}};
    const auto file = vtp_of({mesh});
    const DecodedMesh read = decode_vtp(file, "file");
    EXPECT_EQ(digest(weld(read, mesh.lattice)), digest(with_pairs(mesh))) << label;
    EXPECT_THAT(head_of(file), HasSubstr(label <= 0x7fffffff ? "type=\"Int32\" Name=\"label\""
                                                             : "type=\"Int64\" Name=\"label\""));
  }
  EXPECT_THAT(testing::error_text<InputError>([] { vtp_of({book(3, 6)}); }),
              HasSubstr("label 18446744073709551613"));
}

// Past 2^31 vertices or corners numbers take 64 bits. Of a mesh that is only said to be so large.
TEST(Vtp, NumbersAsManyAsThereAre) {
  StreamTotals totals;
  totals.vertices = 100;
  const auto types = [&](std::uint64_t triangles) {
    totals.triangles = triangles;
    std::string text;
    const ByteSink sink = [&](std::span<const std::byte> bytes) {
      text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      if (text.find("<AppendedData") != std::string::npos) throw std::runtime_error("enough");
    };
    EXPECT_THROW(stream_vtp([](const auto&) {}, totals, sink), std::runtime_error);
    return text;
  };
  EXPECT_THAT(types(0x7fffffff / 3), HasSubstr("\"Int32\" Name=\"connectivity\""));
  EXPECT_THAT(types(0x7fffffff / 3 + 1), HasSubstr("\"Int64\" Name=\"connectivity\""));
}

TEST(Vtp, DamageIsRefusedOrReadAsSomethingElse) {
  TileMesh mesh = book(3, 6);
  mesh.pairs = {{0, exterior}, {1, 7}, {2, 9}};
  const auto whole = vtp_of({mesh});
  constexpr std::size_t behind = 35;  // the end of the XML, which is not looked at
  for (std::size_t size = 0; size + behind < whole.size(); ++size)
    EXPECT_THAT(testing::error_text<FormatError>(
                    [&] { decode_vtp(std::span(whole).first(size), "a.vtp"); }),
                StartsWith("a.vtp: "))
        << size;
  for (std::size_t at = 0; at < whole.size(); ++at)
    for (const int bit : {0, 3, 7}) {
      auto flipped = whole;
      flipped[at] ^= static_cast<std::byte>(1 << bit);
      try {
        const DecodedMesh read = decode_vtp(flipped, "a.vtp");
        for (const auto& t : read.triangles)
          for (const std::uint32_t v : t) ASSERT_LT(v, read.positions.size());
      } catch (const FormatError& error) {
        EXPECT_THAT(error.what(), StartsWith("a.vtp: "));
      }
    }
}

// Prints points, triangles, area, volume, whether normals face outward, and of triangles the sums of
// their labels.
constexpr const char* by_vtk = R"(
import sys
import numpy as np
import vtkmodules.all as vtk
from vtkmodules.util.numpy_support import vtk_to_numpy

for name in ('torus.vtp', 'book.vtp', 'large.vtp'):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(name)
    reader.Update()
    mesh = reader.GetOutput()
    measure = vtk.vtkMassProperties()
    measure.SetInputData(mesh)
    measure.Update()
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    corners = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    normals, outward = mesh.GetPointData().GetNormals(), -1
    if normals:
        a, b, c = (points[corners[:, k]] for k in range(3))
        across = np.cross(b - a, c - a)
        mean = vtk_to_numpy(normals)[corners].mean(axis=1)
        outward = int((np.einsum('ij,ij->i', across, mean) > 0).sum())
    sums = [-1, -1]
    if mesh.GetCellData().HasArray('label'):
        arrays = [vtk_to_numpy(mesh.GetCellData().GetArray(n)) for n in ('label', 'label_outside')]
        sums = [int(array.astype(object).sum()) for array in arrays]
    with open(name + '.txt', 'w') as out:
        print(mesh.GetNumberOfPoints(), mesh.GetNumberOfCells(), measure.GetSurfaceArea(),
              measure.GetVolume(), outward, *sums, file=out)
)";

TEST(Vtp, IsWhatVtkReads) {
  const auto python = testing::python_with("vtkmodules");
  if (!python) GTEST_SKIP() << "needs Python with vtkmodules (python3-vtk9)";
  const testing::TempDirectory folder;
  TileMesh torus = vtp_torus();
  for (auto& normals : torus.normals) normals[1] = normals[2] = no_normal;
  TileMesh labels = book(3, 6), large = labels;
  labels.pairs = {{0, exterior}, {1, 7}, {2, 9}};
  large.pairs = {{0, exterior}, {1, Material{1} << 58}, {2, 9}};
  write_whole_file(folder / "torus.vtp", vtp_of(testing::cut_into_tiles(torus, 3)),
                   Durability::rename_only);
  write_whole_file(folder / "book.vtp", vtp_of({labels}), Durability::rename_only);
  write_whole_file(folder / "large.vtp", vtp_of({large}), Durability::rename_only);
  testing::run_python(*python, folder.path(), by_vtk);
  struct Facts {
    std::size_t points = 0, triangles = 0;
    double area = 0, volume = 0;
    std::int64_t outward = 0, inside = 0, outside = 0;
  };
  const auto facts = [&](const char* name) {
    Facts read;
    std::istringstream(read_text_file(folder / name)) >> read.points >> read.triangles >>
        read.area >> read.volume >> read.outward >> read.inside >> read.outside;
    return read;
  };
  const Facts of_torus = facts("torus.vtp.txt");
  const MeshMeasure measured = measure(torus.positions, torus.triangles);
  EXPECT_EQ(of_torus.points, torus.positions.size());
  EXPECT_EQ(of_torus.triangles, torus.triangles.size());
  const double area = surface_area(measured, torus.lattice);
  const double volume = enclosed_volume(measured, torus.lattice);
  EXPECT_NEAR(of_torus.area, area, 1e-4 * area);
  EXPECT_NEAR(of_torus.volume, volume, 1e-2 * volume);
  EXPECT_EQ(of_torus.outward, static_cast<std::int64_t>(torus.triangles.size()));
  // Each sheet has two triangles for each of its six squares.
  const Facts of_book = facts("book.vtp.txt"), of_large = facts("large.vtp.txt");
  EXPECT_EQ(of_book.triangles, labels.triangles.size());
  EXPECT_EQ(of_book.points, labels.positions.size());
  EXPECT_EQ(of_book.outward, -1);
  EXPECT_EQ(of_book.inside, 12 * (0 + 1 + 2));
  EXPECT_EQ(of_book.outside, 12 * (-1 + 7 + 9));
  EXPECT_EQ(of_large.outside, 12 * (-1 + (std::int64_t{1} << 58) + 9));
}

}  // namespace
}  // namespace voxweld
