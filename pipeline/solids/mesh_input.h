// A closed triangle mesh as the input: empty space around it, with the mesh as the first solid.
#pragma once

#include <memory>

#include "pipeline/config/config.h"
#include "stages/solids/solid.h"
#include "storage/types/volume.h"

namespace voxweld {

// Samples as those of empty space; the surface is the solid's.
class MeshVolume final : public RangedSource {
 public:
  MeshVolume(const VolumeGeometry& geometry, Solid solid);

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override { space_->read(box, out); }
  ValueRange range(const Box3& box) const override { return space_->range(box); }

  // In the frame spacing * sample index.
  const Solid& solid() const { return solid_; }

 private:
  VolumeInfo info_;
  std::unique_ptr<RangedSource> space_;
  Solid solid_;
};

// The lattice a mesh is sampled on: of cells of one side, with the mesh's own coordinates for those
// of the output (VolumeGeometry::first). Faces at multiples of a cell from the lowest ones lie
// between samples. Throws InputError where the mesh is too small or too large for the cell.
// Precondition: config.format is mesh.
VolumeGeometry mesh_geometry(const InputConfig& config, const Bounds& bounds);

// Warns of each solid that an edit adds and the lattice is too small for: what of it lies outside
// is cut off. edits: those of the config, in the frame spacing * sample index.
void warn_of_cut_edits(const VolumeGeometry& geometry, const Edits& edits);

// Reads and checks the mesh; InputError or FormatError where there is none to take.
std::shared_ptr<MeshVolume> open_mesh_input(const Config& config);

}  // namespace voxweld
