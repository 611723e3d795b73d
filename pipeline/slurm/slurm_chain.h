// A whole run handed to Slurm at once, as jobs that wait for each other: nothing of ours stays
// behind. What a lost task leaves undone is made up for by the job behind its array, which does all
// that is missing; since every step does only that, none can be repeated in vain.
//
//   ingest        array   the brick store, by shards
//   ingest-rest   job     what is missing of it, and what belongs to the whole
//   build         array   octrees, by shards
//   merge         job     octrees that are missing, then the top tree and the tile plan
//   stitch        array   tile meshes, by parts of the plan
//   and with simplify.refine
//   stitch-rest   job     those that are missing
//   refine        array   a first pass over the mesh, by ranges of cubes
//   refine-rest   job     what is missing of it
//   seams         array   the second, alike
//   seams-rest    job
//   mend          array   a third, where triangles still intersect
//   mend-rest     job
//   remend        array   a fourth, where they still do
//   remend-rest   job
//   retile        array   the refined mesh cut into tiles
//   and with simplify.triangles or simplify.ratio, each followed by a job as the others are
//   survey        array   before refine
//   recount       array   before seams
//
//   encode        array   their assets
//   finish        job     all that is missing, the merged mesh, the manifest
#pragma once

#include <string>
#include <vector>

#include "pipeline/run/jobs.h"
#include "pipeline/slurm/slurm_run.h"

namespace voxweld {

struct SubmittedStep {
  std::string name;
  std::int64_t job = 0;
  std::size_t tasks = 1;
  std::filesystem::path folder;  // script, logs, reports
};

// Throws InputError when tasks of this config are in Slurm already.
std::vector<SubmittedStep> submit_chain(RunContext& context, const SlurmSetup& setup,
                                        SlurmClient& client);

}  // namespace voxweld
