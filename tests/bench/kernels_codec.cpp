// Codecs of the brick store, on a chunk of 64 samples a side.
#include "storage/store/codec.h"
#include "tests/bench/kernels_support.h"

namespace voxweld::bench {
namespace {

// What a chunk goes through, by its number: blosc (lz4), zstd, or its checksum alone.
CodecChain chain_of(std::int64_t number) {
  CodecChain chain;
  chain.checksums_outside = 1;
  switch (number) {
    case 0:
      chain.compressor.emplace();
      break;
    case 1:
      chain.compressor = Compressor{CompressorKind::zstd, "", 3, Shuffle::none};
      break;
    default:
      break;  // the checksum alone
  }
  return chain;
}

struct Chunk {
  static const Chunk& get() {
    static const Chunk chunk;
    return chunk;
  }
  GyroidVolume volume{64};
  ChunkForm form{volume.samples.size(), sizeof(std::uint16_t)};
};

// Items are samples, bytes those of the samples.
void chunk_encode(benchmark::State& state) {
  const Chunk& chunk = Chunk::get();
  const CodecChain chain = chain_of(state.range(0));
  std::vector<std::byte> encoded;
  while (state.KeepRunning()) encode_chunk(chain, chunk.form, chunk.volume.samples, encoded);
  state.counters["share"] =
      static_cast<double>(encoded.size()) / static_cast<double>(chunk.form.bytes);
  count(state, chunk.form.bytes / chunk.form.sample_bytes, chunk.form.bytes);
}
BENCHMARK(chunk_encode)->ArgName("codec")->DenseRange(0, 2)->Unit(benchmark::kMicrosecond);

void chunk_decode(benchmark::State& state) {
  const Chunk& chunk = Chunk::get();
  const CodecChain chain = chain_of(state.range(0));
  std::vector<std::byte> encoded, samples(chunk.form.bytes), scratch;
  encode_chunk(chain, chunk.form, chunk.volume.samples, encoded);
  while (state.KeepRunning()) {
    const std::string wrong = decode_chunk(chain, chunk.form, encoded, samples, scratch);
    if (wrong.empty()) continue;
    state.SkipWithError(wrong.c_str());
    return;
  }
  count(state, chunk.form.bytes / chunk.form.sample_bytes, chunk.form.bytes);
}
BENCHMARK(chunk_decode)->ArgName("codec")->DenseRange(0, 2)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace voxweld::bench
