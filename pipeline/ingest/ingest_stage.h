// Ingest: the input volume to something any box of which can be read by any thread: the input
// itself where it allows that, else a brick store.
#pragma once

#include <optional>

#include "pipeline/solids/streamed_mesh.h"
#include "pipeline/stage/context.h"
#include "pipeline/stage/volume.h"
#include "storage/store/layout.h"
#include "storage/types/histogram.h"

namespace voxweld {

struct IngestJob {
  VolumeInfo info;  // of the input: cropped, spacing and unit as the config has them
  // The input itself. Null where its brick store is known to be of the files as they are: then
  // nothing opens it again, and the image module is not loaded for it.
  std::shared_ptr<SampleSource> input;
  std::optional<Solid> solid;  // as Volume has it
  Hash128 stamp;               // of the input's files and how they are read
  Hash128 parameters;
  bool file_per_slice = false;  // info.files are the slices: a layer's shards depend on a few
  std::filesystem::path folder;
  bool copy = false;       // make a brick store
  bool histogram = false;  // needed: the isovalue is to be chosen
  bool labels = false;     // are to be counted
  // A mesh as the input that is read by pieces: ingest cuts it up. Else null.
  std::shared_ptr<StreamedMesh> mesh;

  // Whether there are units: otherwise the input is read in place, and at once if at all.
  bool by_shards() const { return copy || labels; }
};

// Opens the input the config names. Throws InputError where work.copy = false does not fit it.
// interrupt: asked where that takes long, as with large meshes; may be null.
IngestJob plan_ingest(const Config& config, const std::filesystem::path& folder,
                      const InterruptFlag* interrupt);

struct IngestStatus {
  std::uint64_t units = 0, missing = 0;  // shards to copy or to count the labels of
  bool metadata_missing = false;         // the store's zarr.json
  bool histogram_missing = false;        // where the isovalue is to be chosen from it
  bool labels_missing = false;           // the volume's counts, where labels are meshed
  bool mesh_missing = false;             // the mesh that is to be cut up; counted in missing
  bool current() const {
    return missing == 0 && !metadata_missing && !histogram_missing && !labels_missing;
  }
};
// Of the units context selects, which are numbered x fastest.
IngestStatus ingest_status(const RunContext& context, const IngestJob& job);

// What is missing, in words; of a status that is not current.
std::string missing_text(const IngestJob& job, const IngestStatus& status);

// The missing ones; none where the input is read in place.
std::vector<Unit> missing_units(const RunContext& context, const IngestJob& job);

// What one unit of it takes. No bytes where there are none.
StageMemory ingest_memory(const Config& config, const IngestJob& job);
void run_ingest(RunContext& context, const IngestJob& job);

// What ingest leaves. Precondition: it is current.
Volume ingested_volume(const Config& config, const IngestJob& job);
std::optional<Histogram> read_histogram(const IngestJob& job);

// The range of all samples, for messages: from the store's records or by reading everything.
ValueRange whole_range(RunContext& context, const Volume& volume);

}  // namespace voxweld
