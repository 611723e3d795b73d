// Ingest: the input volume to something any box of which can be read by any thread: the input
// itself where it allows that, else a brick store.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "pipeline/solids/streamed_mesh.h"
#include "pipeline/stage/stage_work.h"
#include "pipeline/stage/volume.h"
#include "storage/store/layout.h"
#include "storage/types/histogram.h"

namespace voxweld {

struct EarlierIngest;

// The config's last filter that has to have seen the whole volume (FilterConfig::is_global).
struct PiecesJob {
  std::shared_ptr<SampleSource> before;  // what it finds its pieces in
  std::filesystem::path path;            // of what it finds
  Hash128 key;
};

struct IngestJob {
  // Of the input: cropped, spacing and unit as the config has them, and filtered.
  VolumeInfo info;
  // All files the result depends on, as they were before they were read: the input's, the map of
  // labels, meshes of edits.
  std::vector<InputFile> files;
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
  // What has to be ingested before, in this order, where filters read boxes of what the input gives
  // otherwise: the volume up to some filter, masks.
  std::vector<std::shared_ptr<const EarlierIngest>> earlier;
  std::optional<PiecesJob> pieces;  // then earlier.front() is the volume up to that filter
  // A mesh as the input that is read by pieces: ingest cuts it up. Else null.
  std::shared_ptr<StreamedMesh> mesh;

  // Whether there are units: otherwise the input is read in place, and at once if at all.
  bool by_shards() const { return copy || labels; }
};

// An ingest with a folder of its own: another config with the same input may use it too.
struct EarlierIngest {
  Config config;
  IngestJob job;
};

// Opens the input the config names. Throws InputError where work.copy = false does not fit it.
// interrupt: asked where that takes long, as with large meshes; may be null.
IngestJob plan_ingest(const Config& config, const std::filesystem::path& folder,
                      const InterruptFlag* interrupt);

// What ingest has to do for it: units are shards to copy or to count the labels of, x fastest, or
// the one mesh that is to be cut up; none where the input is read in place. job: outlives the work.
std::unique_ptr<StageWork> ingest_stage(const Config& config, const IngestJob& job);

// The first of job.files that is not as it was when the job was planned, if any.
std::optional<std::string> changed_file(const IngestJob& job);
// Whether the input has files besides (SampleSource::each_file): those go into the stamps of what
// is made from them.
bool lies_in_unlisted_files(const IngestJob& job);

// What ingest leaves. Precondition: it is current. job: outlives the volume.
Volume ingested_volume(const Config& config, const IngestJob& job);
std::optional<Histogram> read_histogram(const IngestJob& job);

// The range of all samples in real values, for messages: from the store's records or by reading
// everything.
ValueRange whole_range(RunContext& context, const Volume& volume);

}  // namespace voxweld
