// A mesh as the input that does not fit memory: read once, kept in bins that build reads brick by
// brick (mesh_binning.h). What comes out is the same to the bit.
#pragma once

#include "pipeline/solids/mesh_binning.h"
#include "pipeline/solids/mesh_input.h"
#include "pipeline/stage/context.h"
#include "pipeline/stage/stage_jobs.h"

namespace voxweld {

struct StreamedMesh {
  std::filesystem::path path;
  std::filesystem::path folder;  // of ingest
  MeshRecord record;
  MeshBinning binning;
  std::shared_ptr<MeshVolume> volume;  // to be read once the bins are there
  // What reading the file left, where this process has read it.
  std::shared_ptr<const SpooledMesh> spooled;
};

// Whether the config's input is a mesh to be read so. The answer is the same in every process.
bool streams_mesh(const Config& config);

// What is known of the mesh, from what an earlier process wrote into `folder` where the file has
// the same size and time since; else the file is read and checked.
// InputError, FormatError as open_mesh_input; Interrupted.
std::shared_ptr<StreamedMesh> plan_streamed_mesh(const Config& config,
                                                 const std::filesystem::path& folder,
                                                 const InterruptFlag* interrupt);

bool bins_are_current(const StreamedMesh& mesh);

// Makes the bins that are missing. Throws what reading the mesh does; Interrupted.
void make_bins(const Config& config, StreamedMesh& mesh, const InterruptFlag* interrupt);
// What that takes.
StageMemory streaming_memory();

// Of the largest bin, for build. Precondition: the bins are current.
LargestBin largest_bin(const StreamedMesh& mesh);

}  // namespace voxweld
