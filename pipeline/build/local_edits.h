// Edits as one brick sees them: meshes that lie in pieces on disk, by the piece.
#pragma once

#include "stages/contouring/parameters.h"
#include "storage/types/box.h"

namespace voxweld {

class LocalEdits {
 public:
  explicit LocalEdits(const ContourParameters& parameters)
      : whole_(parameters), local_(parameters) {}

  // Good until the next call; its pieces are held until then. samples: sign_samples of the brick,
  // clipped to the volume (stages/build/build_brick.h).
  // Throws what reading a piece throws: DamagedArtifact, StorageError.
  const ContourParameters& around(const Box3& samples);

 private:
  const ContourParameters& whole_;
  ContourParameters local_;
};

}  // namespace voxweld
