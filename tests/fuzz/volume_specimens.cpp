// Volumes in every format that is read.
#include "tests/fuzz/volume_writer.h"

namespace voxweld::testing {

std::vector<Specimen> write_volumes(const std::filesystem::path& program,
                                    const std::filesystem::path& root) {
  VolumeWriter to(root);
  write_files(to);
  write_arrays(to, program, root);
  write_images(to);
  return to.take();
}

}  // namespace voxweld::testing
