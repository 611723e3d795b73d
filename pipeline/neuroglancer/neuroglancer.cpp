#include "pipeline/neuroglancer/neuroglancer.h"

#include <tbb/global_control.h>
#include <tbb/info.h>

#include <numeric>

#include "pipeline/neuroglancer/folder.h"
#include "pipeline/neuroglancer/info_files.h"
#include "pipeline/neuroglancer/multilod.h"
#include "pipeline/output/level_cut.h"
#include "stages/encode/glb.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

std::vector<std::uint64_t> ids_of(const SegmentList& list) {
  std::vector<std::uint64_t> ids;
  for (const Segment& segment : list.segments) ids.push_back(segment.id);
  return ids;
}

std::vector<std::size_t> as_listed(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  return order;
}

}  // namespace

NeuroglancerTotals write_neuroglancer(const std::filesystem::path& output,
                                      const std::filesystem::path& folder,
                                      const NeuroglancerOptions& options) {
  if (options.legacy && options.sharded)
    throw InputError("the legacy format has no shards; leave out --legacy or --sharded");
  require_output(output);
  const Manifest manifest = read_manifest(output / manifest_name);
  const SegmentList list = read_segments(output, manifest, options.fragment_triangles);
  claim_folder(folder, output, options.force);

  const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  NeuroglancerTotals totals;
  totals.left_out_zero = list.left_out_zero;
  totals.no_unit = !metres_per(manifest.frame.unit);
  if (!options.legacy) totals.levels = 1 + top_of(listed_levels(output));
  InfoFacts facts{options.legacy, manifest.open_border, {}};
  if (options.sharded) facts.sharding = sharding_for(list.segments.size());

  FragmentSort sort({output, manifest, list,
                     facts.sharding ? order_in_shards(ids_of(list), *facts.sharding)
                                    : as_listed(list.segments.size()),
                     totals.levels},
                    folder);
  sort.sort(threads, options.interrupt);
  const FragmentWork work{manifest, list, totals.levels, threads, options.interrupt};
  if (options.legacy) {
    write_legacy(sort, work, folder, totals);
  } else {
    const auto store = facts.sharding ? shard_store(folder, *facts.sharding) : file_store(folder);
    write_multilod(sort, work, *store, totals);
  }
  write_segment_properties(list, manifest, folder);
  write_info(facts, manifest.frame, folder);
  return totals;
}

}  // namespace voxweld
