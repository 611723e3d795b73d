#include "storage/spool/chunk_spool.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "storage/support/error.h"
#include "storage/types/chunk_grid.h"

namespace voxweld {
namespace {

// Pieces of more than one chunk are at most that large: longer writes gain nothing.
constexpr std::uint64_t largest_run = std::uint64_t{8} << 20;

// The rows of a box to where they belong; rows that follow one another in the file, at once.
void write_box(const Box3& box, std::span<const std::byte> samples, const VolumeInfo& info,
               AtomicFile& file) {
  const Index3 size = info.geometry.size, extent = box.size();
  const std::uint64_t width = sample_bytes(info.type);
  const bool whole_rows = extent.x == size.x;
  const std::int64_t rows = whole_rows ? extent.y : 1;
  const std::size_t bytes = static_cast<std::size_t>(extent.x * rows) * width;
  std::size_t at = 0;
  for (std::int64_t z = box.lo.z; z < box.hi.z; ++z)
    for (std::int64_t y = box.lo.y; y < box.hi.y; y += rows, at += bytes) {
      const std::int64_t first = (z * size.y + y) * size.x + box.lo.x;
      file.write_at(static_cast<std::uint64_t>(first) * width, samples.subspan(at, bytes));
    }
}

// Runs of chunks, taken by threads in turn. The first failure ends them all.
class ChunkCopy {
 public:
  ChunkCopy(const SampleSource& source, AtomicFile& file, const SpoolOptions& options)
      : source_(source), file_(file), options_(options), grid_(source.info()) {
    const VolumeInfo& info = source.info();
    const std::uint64_t least = chunk_spool_memory(info);
    threads_ = static_cast<int>(std::clamp<std::uint64_t>(
        options.memory / least, 1, static_cast<std::uint64_t>(std::max(1, options.threads))));
    const std::uint64_t spare =
        options.memory / static_cast<std::uint64_t>(threads_) - info.largest_decode;
    length_ = grid_.run_length(std::min(spare, largest_run));
    runs_ = grid_.runs(length_);
    total_ = spool_bytes(info);
  }

  void run() {
    std::vector<std::jthread> others;
    for (int i = 1; i < threads_; ++i) others.emplace_back([this] { work(); });
    work();
    others.clear();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void work() try {
    std::vector<std::byte> samples;
    while (!stop_.load(std::memory_order_relaxed)) {
      const std::uint64_t i = next_.fetch_add(1, std::memory_order_relaxed);
      if (i >= runs_) return;
      if (options_.cancel != nullptr && options_.cancel->load(std::memory_order_relaxed))
        throw Interrupted();
      const Box3 box = grid_.run(i, length_);
      samples.resize(static_cast<std::size_t>(box.count()) * sample_bytes(source_.info().type));
      source_.read(box, samples.data());
      write_box(box, samples, source_.info(), file_);
      const std::scoped_lock lock(mutex_);
      done_ += samples.size();
      if (options_.progress) options_.progress({done_, total_});
    }
  } catch (...) {
    stop_.store(true, std::memory_order_relaxed);
    const std::scoped_lock lock(mutex_);
    if (!failure_) failure_ = std::current_exception();
  }

  const SampleSource& source_;
  AtomicFile& file_;
  const SpoolOptions& options_;
  const ChunkGrid grid_;
  int threads_ = 1;
  std::int64_t length_ = 1;
  std::uint64_t runs_ = 0, total_ = 0;
  std::atomic<std::uint64_t> next_ = 0;
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  std::uint64_t done_ = 0;
  std::exception_ptr failure_;
};

}  // namespace

std::uint64_t chunk_spool_memory(const VolumeInfo& info) {
  return info.largest_decode + ChunkGrid(info).chunk_bytes();
}

void write_chunks(const SampleSource& source, AtomicFile& file, const SpoolOptions& options) {
  file.extend(spool_bytes(source.info()));
  ChunkCopy(source, file, options).run();
}

}  // namespace voxweld
