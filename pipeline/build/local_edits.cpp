#include "pipeline/build/local_edits.h"

#include "stages/solids/lattice_solid.h"

namespace voxweld {

const ContourParameters& LocalEdits::around(const Box3& samples) {
  if (samples.empty()) return whole_;
  for (std::size_t i = 0; i < whole_.edits.size(); ++i) {
    const std::shared_ptr<const LatticeSolid>& mesh = whole_.edits[i].solid.mesh;
    if (mesh == nullptr) continue;
    local_.edits[i].solid.mesh.reset();  // the last brick's, before there is another
    std::shared_ptr<const LatticeSolid> piece = mesh->near(samples);
    if (piece == nullptr) piece = mesh;
    local_.edits[i].solid.mesh = std::move(piece);
  }
  return local_;
}

}  // namespace voxweld
