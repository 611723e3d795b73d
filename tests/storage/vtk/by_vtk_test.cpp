// Files that VTK itself has written, in all of its ways, and what VTK reads from them.
#include <fstream>

#include "storage/support/byte_order.h"
#include "tests/storage/volumes/known_volume.h"
#include "tests/support/by_python.h"

namespace voxweld::testing {
namespace {

// Writes NAME.vti and NAME.vtk, and what VTK's readers make of them: NAME.raw, samples, and
// NAME.txt: size, spacing, origin of the first sample, the axes.
constexpr const char* script = R"(
import numpy as np
import vtkmodules.all as vtk
from vtkmodules.util import numpy_support

def note(name, reader):
    reader.SetFileName(name)
    reader.Update()
    image = reader.GetOutput()
    array = numpy_support.vtk_to_numpy(image.GetPointData().GetScalars())
    array.tofile(name + '.raw')
    first = [image.GetExtent()[i] for i in (0, 2, 4)]
    point = [0.0, 0.0, 0.0]
    image.TransformIndexToPhysicalPoint(*first, point)
    matrix = image.GetDirectionMatrix()
    axes = [matrix.GetElement(row, column) for column in range(3) for row in range(3)]
    with open(name + '.txt', 'w') as out:
        for value in (array.dtype.name, *image.GetDimensions(), *image.GetSpacing(), *point, *axes):
            print(value if isinstance(value, str) else repr(float(value)), file=out)

def image_of(type_name, turned):
    image = vtk.vtkImageData()
    image.SetExtent(2, 41, -3, 25, 0, 20)
    image.SetSpacing(0.3, 2, 1.25)
    image.SetOrigin(10, -20, 30)
    if turned:
        image.SetDirectionMatrix(0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1)
    count = image.GetNumberOfPoints()
    values = np.random.default_rng(4).integers(0, 100, count)
    values[count // 3:] = 7
    array = numpy_support.numpy_to_vtk(values.astype(type_name), deep=True)
    array.SetName('density [g] of it')
    image.GetPointData().SetScalars(array)
    return image

types = ['int8', 'uint8', 'int16', 'uint16', 'int32', 'uint32', 'int64', 'uint64', 'float32', 'float64']
number = 0
for type_name in types:
    image = image_of(type_name, True)
    for mode in ('Ascii', 'Binary', 'Appended', 'Raw'):
        for codec in ('None', 'ZLib', 'LZ4', 'LZMA'):
            for order in ('Little', 'Big'):
                for words in (32, 64):
                    if mode == 'Ascii' and (codec != 'None' or words == 64):
                        continue
                    writer = vtk.vtkXMLImageDataWriter()
                    writer.SetInputData(image)
                    name = f'{type_name}-{mode}-{codec}-{order}-{words}.vti'
                    writer.SetFileName(name)
                    getattr(writer, 'SetDataModeTo' + ('Appended' if mode == 'Raw' else mode))()
                    writer.SetEncodeAppendedData(mode == 'Appended')
                    getattr(writer, 'SetCompressorTypeTo' + codec)()
                    getattr(writer, f'SetByteOrderTo{order}Endian')()
                    getattr(writer, f'SetHeaderTypeToUInt{words}')()
                    writer.SetBlockSize(2048)
                    assert writer.Write() == 1
                    note(name, vtk.vtkXMLImageDataReader())
    image = image_of(type_name, False)
    points = vtk.vtkStructuredPoints()
    points.DeepCopy(image)
    for binary in (False, True):
        for extent in (False, True):
            writer = vtk.vtkStructuredPointsWriter()
            writer.SetInputData(points)
            writer.SetFileType(2 if binary else 1)
            writer.SetWriteExtent(extent)
            name = f'{type_name}-{binary}-{extent}.vtk'
            writer.SetFileName(name)
            assert writer.Write() == 1
            note(name, vtk.vtkStructuredPointsReader())
)";

void expect_as_vtk(const std::filesystem::path& path) {
  SCOPED_TRACE(path.string());
  const auto source = open_path(path);
  const VolumeInfo& info = source->info();
  std::ifstream facts(path.string() + ".txt");
  std::string type;
  facts >> type;
  double value = 0;
  const auto next = [&] {
    facts >> value;
    return value;
  };
  for (int a = 0; a < 3; ++a) EXPECT_EQ(static_cast<double>(info.geometry.size[a]), next());
  for (int a = 0; a < 3; ++a) EXPECT_EQ(info.geometry.spacing[a], next());
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(info.geometry.origin[a], next(), 1e-12);
  for (const Vec3& axis : info.geometry.direction)
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(axis[a], next(), 1e-12);
  ASSERT_TRUE(facts.good());
  EXPECT_EQ(info.warnings.size(), 0U);
  if (info.scale.slope == 255) {  // bytes, which it writes as colours from 0 to 1
    const Bytes numbers = read_box(*source, {{}, info.geometry.size});
    const Bytes bytes = read_whole_file(path.string() + ".raw");
    for (std::size_t i = 0; i < bytes.size(); ++i)
      ASSERT_NEAR(info.scale.real(load_as<float>(numbers.data(), 4 * i, std::endian::native)),
                  std::to_integer<int>(bytes[i]), 1e-3);
    return;
  }
  const KnownVolume volume{*parse_sample_type(type), info.geometry.size,
                           read_whole_file(path.string() + ".raw")};
  expect_volume(*source, volume);
}

TEST(ByVtk, AsItsOwnReadersHaveIt) {
  const auto python = python_with("vtkmodules");
  if (!python) GTEST_SKIP() << "needs Python with vtkmodules (python3-vtk9)";
  const TempDirectory folder;
  run_python(*python, folder.path(), script);
  int xml = 0, legacy = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const auto ending = entry.path().extension();
    if (ending != ".vti" && ending != ".vtk") continue;
    ++(ending == ".vti" ? xml : legacy);
    expect_as_vtk(entry.path());
  }
  EXPECT_EQ(xml, 10 * (2 + 3 * 4 * 2 * 2));
  EXPECT_EQ(legacy, 40);
}

}  // namespace
}  // namespace voxweld::testing
