#include "pipeline/solids/edge_parity.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace voxweld {
namespace {

constexpr std::uint64_t least_buffer = 4096 / sizeof(PlaceEdge), most_buffer = 1 << 14;  // edges

bool less(const PlaceEdge& a, const PlaceEdge& b) {
  return a.low != b.low ? place_before(a.low, b.low) : place_before(a.high, b.high);
}

bool same(const PlaceEdge& a, const PlaceEdge& b) {
  return a.low == b.low && a.high == b.high;
}

}  // namespace

// One run while it is merged.
class EdgeParity::Run {
 public:
  Run(const ScratchFile& file, std::uint64_t begin, std::uint64_t end, std::uint64_t buffer)
      : file_(file), at_(begin), end_(end), most_(buffer) {
    fill();
  }
  bool done() const { return next_ == buffer_.size(); }
  const PlaceEdge& edge() const { return buffer_[next_]; }
  void advance() {
    if (++next_ == buffer_.size()) fill();
  }

 private:
  void fill() {
    next_ = 0;
    buffer_.resize(std::min<std::uint64_t>(most_, (end_ - at_) / sizeof(PlaceEdge)));
    const auto bytes = std::as_writable_bytes(std::span(buffer_));
    file_.read(at_, bytes);
    at_ += bytes.size();
  }

  const ScratchFile& file_;
  std::uint64_t at_, end_, most_;
  std::vector<PlaceEdge> buffer_;
  std::size_t next_ = 0;
};

EdgeParity::EdgeParity(std::filesystem::path folder, std::uint64_t memory)
    : folder_(std::move(folder)),
      most_(std::max<std::size_t>(memory / sizeof(PlaceEdge), least_buffer)) {}

EdgeParity::~EdgeParity() = default;

void EdgeParity::add(Vec3 a, Vec3 b) {
  if (held_.capacity() == 0) held_.reserve(most_);  // untouched, it takes no memory
  if (held_.size() == most_) {
    cancel();
    if (held_.size() > most_ / 2) spill();
  }
  a = a + Vec3{};
  b = b + Vec3{};
  held_.push_back(place_before(a, b) ? PlaceEdge{a, b} : PlaceEdge{b, a});
}

void EdgeParity::cancel() {
  std::sort(held_.begin(), held_.end(), less);
  std::size_t kept = 0;
  for (const PlaceEdge& edge : held_) {
    if (kept > 0 && same(held_[kept - 1], edge))
      --kept;
    else
      held_[kept++] = edge;
  }
  held_.resize(kept);
}

void EdgeParity::spill() {
  if (file_ == nullptr) file_ = std::make_unique<ScratchFile>(folder_);
  file_->append(std::as_bytes(std::span(held_)));
  ends_.push_back(file_->size());
  held_.clear();
}

void EdgeParity::finish(const std::function<void(const PlaceEdge&)>& f) {
  cancel();
  if (file_ == nullptr) {
    for (const PlaceEdge& edge : held_) f(edge);
    held_ = {};
    return;
  }
  spill();
  held_ = {};
  const std::uint64_t buffer =
      std::clamp<std::uint64_t>(most_ / ends_.size(), least_buffer, most_buffer);
  std::vector<std::unique_ptr<Run>> heap;
  std::uint64_t begin = 0;
  for (const std::uint64_t end : ends_) {
    if (end > begin) heap.push_back(std::make_unique<Run>(*file_, begin, end, buffer));
    begin = end;
  }
  const auto later = [](const auto& a, const auto& b) { return less(b->edge(), a->edge()); };
  std::make_heap(heap.begin(), heap.end(), later);
  PlaceEdge last;
  bool odd = false;  // whether `last` is pending
  while (!heap.empty()) {
    std::pop_heap(heap.begin(), heap.end(), later);
    Run& run = *heap.back();
    const PlaceEdge edge = run.edge();
    run.advance();
    if (run.done())
      heap.pop_back();
    else
      std::push_heap(heap.begin(), heap.end(), later);
    const bool again = odd && same(last, edge);
    if (odd && !again) f(last);
    odd = !again;
    last = edge;
  }
  if (odd) f(last);
  ends_.clear();
  file_.reset();
}

}  // namespace voxweld
