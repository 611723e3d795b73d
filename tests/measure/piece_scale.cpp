// How long finding the pieces of a volume takes, and reading what a filter leaves of them. Prints
// seconds and the process's peak memory after each.
// usage: piece_scale VOLUME ISOVALUE keep|fill VOXELS SCRATCH_FILE [MEMORY_MIB] [OUTPUT_RAW]
// keep 0: the largest. OUTPUT_RAW: what is left, as samples one behind the other.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <cstdlib>
#include <thread>

#include "pipeline/filter/pieces.h"
#include "storage/readers/open_volume.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "tests/measure/scale_support.h"

namespace voxweld {
namespace {

// In slabs of a block's height.
void read_all(const SampleSource& source, const std::filesystem::path& to) {
  const VolumeInfo& info = source.info();
  const Index3 size = info.geometry.size;
  std::optional<AtomicFile> out;
  if (!to.empty()) out.emplace(to);
  std::vector<std::byte> samples;
  for (std::int64_t z = 0; z < size.z; z += 64) {
    const Box3 slab{{0, 0, z}, {size.x, size.y, std::min(size.z, z + 64)}};
    samples.resize(static_cast<std::size_t>(slab.count()) * sample_bytes(info.type));
    source.read(slab, samples.data());
    if (out) out->append(samples);
  }
  if (out) out->commit(Durability::rename_only);
}

void measure(char** words, int count) {
  InputSpec spec;
  spec.path = words[1];
  const std::shared_ptr<SampleSource> source = open_volume(spec);
  PieceRule rule;
  rule.isovalue = std::atof(words[2]);
  rule.what = std::string(words[3]) == "keep" ? PieceRule::What::keep : PieceRule::What::fill;
  rule.voxels = std::strtoull(words[4], nullptr, 10);
  const std::filesystem::path path = words[5];
  const Hash128 key{1, 2};
  LocalExecutor executor;
  RunContext context = quiet_context(executor);
  context.threads = static_cast<int>(std::thread::hardware_concurrency());
  context.config.run.memory = std::uint64_t(count > 6 ? std::atoi(words[6]) : 4096) << 20;
  remove_file(path);
  timed("find", [&] { find_pieces(context, *source, rule, path, key); });
  fmt::print("artifact {} bytes\n", file_state(path)->size);
  timed("read the input", [&] { read_all(*source, {}); });
  const auto filtered = pieces_source(source, path, key);
  timed("read what is left", [&] { read_all(*filtered, count > 7 ? words[7] : ""); });
}

}  // namespace
}  // namespace voxweld

int main(int count, char** words) {
  if (count < 6) {
    fmt::print(stderr, "usage: piece_scale VOLUME ISOVALUE keep|fill VOXELS SCRATCH [MIB] [RAW]\n");
    return 2;
  }
  try {
    voxweld::measure(words, count);
  } catch (const std::exception& error) {
    fmt::print(stderr, "piece_scale: {}\n", error.what());
    return 1;
  }
  return 0;
}
