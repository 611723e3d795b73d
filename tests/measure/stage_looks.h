// How often the one who drives a run looks at the disk, stage by stage, in round trips to a file
// system. Each is counted in the code named beside it; a path that is asked for twice in a row, or
// the rest of a small file whose first piece was read, costs one trip only.
#pragma once

#include <array>
#include <string_view>

namespace voxweld {

constexpr std::array<std::string_view, 5> simulated_stages = {"ingest", "build", "merge", "stitch",
                                                              "encode"};

// ArtifactReader: open, the header, the index with what follows it
// (storage/artifact/container.cpp).
constexpr double artifact_trips = 3;
// Of a small file the first read brings all: store records, asset records, top-level folders.
constexpr double record_trips = 2;

// Trips for each shard and each tile of the volume.
struct Looks {
  double a_shard = 0, a_tile = 0;
};

struct StageLooks {
  Looks before;   // to see what is missing
  Looks after;    // to see that a unit is done
  Looks closing;  // when all are, in the driver
  Looks inside;   // of the one task of merge: what it checks and reads
};

// ShardFiles: artifacts opened per shard as tiles are gone through in Morton order with the last 64
// kept; found by going through a grid of tiles of 2^3 shards (1.89) and of one shard (1.74).
constexpr double tile_opens = 1.9;

constexpr double look_threads = 16;
constexpr double seen_after_s = 0.2;  // from a task's end to its being seen, at most

// What is missing is known by a stat, assets by their sizes and times; the records of a stamp are
// read once each, and merge opens each shard once.
constexpr std::array<StageLooks, 5> stage_looks = {{
    // Missing: no file. Done: the sizes of shard and record, the record. (ingest_stage.cpp,
    // shard_record.cpp)
    {{1, 0}, {2 + record_trips, 0}, {}, {}},
    // Missing: no file. Done: the file, its artifact, the stamp of its input. (build_stage.cpp)
    {{1, 0}, {1 + artifact_trips + 1 + record_trips, 0}, {}, {}},
    // The one open is in what merge was measured to take. (merge_stage.cpp)
    {{}, {artifact_trips, 0}, {}, {artifact_trips, 0}},
    // Done: its inputs' octrees, the tile artifact. (stitch_stage.cpp, tile_inputs.cpp)
    {{0, 1}, {tile_opens * artifact_trips, 1 + artifact_trips}, {}, {}},
    // Done: artifact, record and both assets. Closing: all records, and a listing of all folders,
    // 256 files each, that clears temporaries. (encode_stage.cpp, asset_record.cpp, run.cpp)
    {{0, 1}, {0, artifact_trips + 1 + record_trips + 2}, {3 * 4.0 / 256, 1 + record_trips}, {}},
}};

// Of each task: its report, when it is over and once more for the figures (slurm_executor.cpp).
constexpr double task_report_trips = 2 * record_trips;
// Of each array: its folders, tasks.txt, script and number.
constexpr double array_trips = 12;
constexpr double looks_a_poll = 200;  // at results of tasks that run (slurm_executor.cpp)

}  // namespace voxweld
