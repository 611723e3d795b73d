// Maps that the Python package mrcfile has written, and what it reads from them.
#include <fstream>

#include "tests/storage/volumes/known_volume.h"
#include "tests/support/by_python.h"

namespace voxweld::testing {
namespace {

constexpr const char* mrcfile_script = R"(
import mrcfile
import numpy as np

random = np.random.default_rng(5)
for type_name in ('int8', 'int16', 'uint16', 'float32'):
    for order in '<>':
        for packed in (None, 'gzip'):
            for extended in (0, 960):
                values = random.integers(0, 120, (9, 11, 13)).astype(np.dtype(type_name).newbyteorder(order))
                name = f'{type_name}-{order == "<"}-{extended}.mrc' + ('.gz' if packed else '')
                with mrcfile.new(name, compression=packed, overwrite=True) as out:
                    if extended:
                        out.set_extended_header(np.zeros(extended, 'u1').view('V80'))
                        out.header.exttyp = b'MRCO'
                    out.set_data(values)
                    out.set_volume()
                    out.voxel_size = (1.5, 2.25, 0.75)
                    out.header.origin = (10, -20, 30)
                assert mrcfile.validate(name)
                with mrcfile.open(name) as back:
                    back.data.astype(back.data.dtype.newbyteorder('=')).tofile(name + '.raw')
                    with open(name + '.txt', 'w') as note:
                        v, o = back.voxel_size, back.header.origin
                        print(type_name, *back.data.shape[::-1], v.x, v.y, v.z, o.x, o.y, o.z, file=note)
)";

TEST(ByMrcfile, AsItReadsThemItself) {
  const auto python = python_with("mrcfile");
  if (!python) GTEST_SKIP() << "needs Python with mrcfile (python3-mrcfile)";
  const TempDirectory folder;
  run_python(*python, folder.path(), mrcfile_script);
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string path = entry.path().string();
    if (!path.ends_with(".mrc") && !path.ends_with(".mrc.gz")) continue;
    SCOPED_TRACE(path);
    ++count;
    const auto source = open_path(path);
    const VolumeGeometry& geometry = source->info().geometry;
    std::ifstream facts(path + ".txt");
    std::string type;
    Index3 size;
    Vec3 spacing, origin;
    facts >> type >> size.x >> size.y >> size.z >> spacing.x >> spacing.y >> spacing.z >>
        origin.x >> origin.y >> origin.z;
    ASSERT_FALSE(facts.fail());
    EXPECT_EQ(geometry.spacing, spacing);
    EXPECT_EQ(geometry.origin, origin);
    EXPECT_EQ(source->info().warnings.size(), 0U);
    expect_volume(*source, {*parse_sample_type(type), size, read_whole_file(path + ".raw")});
  }
  EXPECT_EQ(count, 32);
}

}  // namespace
}  // namespace voxweld::testing
