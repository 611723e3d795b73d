// How often the one who drives a run looks at the disk, stage by stage, in round trips to a file
// system. Each is counted in the code named beside it; a path that is asked for twice in a row, or
// the rest of a small file whose first piece was read, costs one trip only.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace voxweld {

constexpr std::array<std::string_view, 5> simulated_stages = {"ingest", "build", "merge", "stitch",
                                                              "encode"};

// ArtifactReader: open, the header, the index with what follows it
// (storage/artifact/container.cpp).
constexpr double artifact_trips = 3;
// Of a small file the first read brings all: store records, asset records, top-level folders.
constexpr double record_trips = 2;

// Trips, and bytes of assets read, for each shard and each tile of the volume.
struct Looks {
  double a_shard = 0, a_tile = 0;
  double assets_read = 0;  // how often all the stage has written is read again
};

// What a unit, or merge for each shard, takes less than where it was measured.
struct Saved {
  double trips = 0, bytes = 0;
};

struct StageLooks {
  Looks before;   // to see what is missing
  Looks after;    // to see that a unit is done
  Looks closing;  // when all are, in the driver
  Looks inside;   // of the one task of merge: what it checks and reads
  Saved saved;
};

struct LookPreset {
  std::string_view name;
  double threads = 1;            // that look
  double poll_s = 5;             // from a task's end to its being seen, at most
  bool every_task_notes = true;  // all file names of the output, see below
  std::array<StageLooks, 5> stages;
};

constexpr double stamp_records = 27;  // store_stamp: a shard's halo lies in 3 x 3 x 3 store shards
// In a phantom of 4 shards a side it is 2.5^3 of them, of which one has to be read.
constexpr double saved_records = 14.6;
constexpr double record_bytes = 14e3;
// ShardFiles: artifacts opened per shard as tiles are gone through in Morton order with the last 64
// kept; found by going through a grid of tiles of 2^3 shards (1.89) and of one shard (1.74).
constexpr double tile_opens = 1.9;

// pipeline/run as it was when every look was made by one thread.
constexpr LookPreset looks_before = {
    "before",
    1,
    5,
    true,
    {{
        // missing_of: shard_is_current finds no file. Done: the sizes of shard and record, the
        // record. (ingest_stage.cpp, shard_record.cpp)
        {{1, 0, 0}, {2 + record_trips, 0, 0}, {}, {}, {}},
        // state_of: no file; then the file, its artifact, the stamp of its input with a stat and a
        // record each (build_stage.cpp).
        {{1, 0, 0}, {1 + artifact_trips + stamp_records * (1 + record_trips), 0, 0}, {}, {}, {}},
        // run_one: ingest_status and build_is_current of all; merge: two artifacts a shard; then
        // merge_is_current in the driver (run.cpp, merge_stage.cpp).
        {{},
         {artifact_trips, 0, 0},
         {},
         {2 + record_trips + 1 + artifact_trips + stamp_records * (1 + record_trips) +
              2 * artifact_trips,
          0, 0},
         {}},
        // StageWork::look: prepare and a stat; memory: tile_bricks once more.
        // Done: prepare, the tile artifact (stitch_stage.cpp, tile_inputs.cpp).
        {{(tile_opens + 1) * artifact_trips, 1, 0},
         {tile_opens * artifact_trips, 1 + artifact_trips, 0},
         {},
         {},
         {}},
        // tile_is_current: the tile artifact, no record. Done: both, and size, open and content of
        // both assets. Closing: list_tiles, and a listing of all folders, 256 files each, by
        // clear_temporaries_of_tasks (encode_stage.cpp, asset_record.cpp, run.cpp).
        {{0, artifact_trips + 1, 0},
         {0, artifact_trips + 1 + record_trips + 4, 1},
         {3 * 4.0 / 256, 1 + record_trips, 0},
         {},
         {}},
    }},
};

// Looks by several threads, the stamp's records read once each, merge with one open a shard and no
// look before, what is missing known by a stat, assets known by their sizes and times, tasks seen
// by their reports. Costs are to be measured with this.
constexpr LookPreset looks_after = {
    "after",
    16,
    0.2,
    false,
    {{
        {{1, 0, 0}, {2 + record_trips, 0, 0}, {}, {}, {}},
        {{1, 0, 0}, {1 + artifact_trips + 1 + record_trips, 0, 0}, {}, {}, {}},
        // The one open is in what merge was measured to take.
        {{}, {artifact_trips, 0, 0}, {}, {artifact_trips, 0, 0}, {}},
        {{0, 1, 0}, {tile_opens * artifact_trips, 1 + artifact_trips, 0}, {}, {}, {}},
        {{0, 1, 0},
         {0, artifact_trips + 1 + record_trips + 2, 0},
         {3 * 4.0 / 256, 1 + record_trips, 0},
         {},
         {}},
    }},
};

constexpr std::array<LookPreset, 2> look_presets = {looks_before, looks_after};

// Of each task: its report, when it is over and once more for the figures (slurm_executor.cpp).
constexpr double task_report_trips = 2 * record_trips;
// Of each array: its folders, tasks.txt, script and number.
constexpr double array_trips = 12;
// Each encode task read and wrote a note of all tiles' file names, two formats each; now the first
// of a run alone does (output_files.cpp, begin_output).
constexpr double note_bytes_a_tile = 56;
constexpr double looks_a_poll = 200;  // at results of tasks that run (slurm_executor.cpp)

}  // namespace voxweld
