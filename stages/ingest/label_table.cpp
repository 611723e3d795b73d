#include "stages/ingest/label_table.h"

#include <algorithm>
#include <type_traits>

namespace voxweld {
namespace {

constexpr std::size_t first_slots = 1024;

// The finaliser of SplitMix64: neighbouring labels go far apart.
std::uint64_t mixed(std::uint64_t label) {
  label = (label ^ label >> 30) * 0xbf58476d1ce4e5b9ULL;
  label = (label ^ label >> 27) * 0x94d049bb133111ebULL;
  return label ^ label >> 31;
}

}  // namespace

LabelTable::LabelTable(std::size_t most) : most_(most), slots_(std::min(first_slots, 2 * most)) {}

std::uint64_t LabelTable::memory_bytes(std::size_t most) {
  // At most half of the slots are in use; while the table grows the smaller one is there too.
  return std::uint64_t{3} * most * sizeof(LabelCount);
}

void LabelTable::grow() {
  std::vector<LabelCount> larger(2 * slots_.size());
  const std::size_t mask = larger.size() - 1;
  for (const LabelCount& count : slots_) {
    if (count.voxels == 0) continue;
    std::size_t at = mixed(count.label) & mask;
    while (larger[at].voxels != 0) at = (at + 1) & mask;
    larger[at] = count;
  }
  slots_ = std::move(larger);
}

// Where the label is or is to go: then without voxels. Null where there is no room.
LabelCount* LabelTable::place_of(std::uint64_t label) {
  for (;;) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = mixed(label) & mask;
    while (slots_[at].voxels != 0 && slots_[at].label != label) at = (at + 1) & mask;
    if (slots_[at].voxels != 0) return &slots_[at];
    if (size_ == most_) return nullptr;
    if (2 * size_ < slots_.size()) {
      ++size_;
      return &slots_[at];
    }
    grow();
  }
}

// Neighbours are mostly of one label, so the table is asked once for each run of them along x.
template <class T>
std::uint64_t LabelTable::add_samples(const Box3& box, const T* samples, std::uint64_t from) {
  const Index3 size = box.size();
  const auto width = static_cast<std::uint64_t>(size.x);
  const auto count = static_cast<std::uint64_t>(box.count());
  for (std::uint64_t i = from; i < count;) {
    const std::uint64_t row = i / width, x = i % width;
    const std::uint64_t row_end = (row + 1) * width;
    const T value = samples[i];
    std::uint64_t end = i + 1;
    while (end < row_end && samples[end] == value) ++end;
    const std::uint64_t length = end - i;
    if (std::is_signed_v<T> && value < 0) {
      negatives_ += length;
      i = end;
      continue;
    }
    const auto label = static_cast<std::uint64_t>(value);
    const auto rows = static_cast<std::uint64_t>(size.y);
    const Index3 at =
        box.lo + Index3{static_cast<std::int64_t>(x), static_cast<std::int64_t>(row % rows),
                        static_cast<std::int64_t>(row / rows)};
    const auto coordinate = [](std::int64_t v) { return static_cast<std::uint32_t>(v); };
    const LabelCount run{label,
                         length,
                         {coordinate(at.x), coordinate(at.y), coordinate(at.z)},
                         {coordinate(at.x + static_cast<std::int64_t>(length)),
                          coordinate(at.y + 1), coordinate(at.z + 1)}};
    if (!add(run)) return i;
    i = end;
  }
  return count;
}

std::uint64_t LabelTable::add(SampleType type, const Box3& box, std::span<const std::byte> samples,
                              std::uint64_t from) {
  return dispatch_sample_type(type, [&](auto tag) -> std::uint64_t {
    using T = typename decltype(tag)::type;
    if constexpr (std::is_integral_v<T>)
      return add_samples(box, reinterpret_cast<const T*>(samples.data()), from);
    return static_cast<std::uint64_t>(box.count());
  });
}

bool LabelTable::add(const LabelCount& count) {
  if (taken_) clear();
  LabelCount* const place = place_of(count.label);
  if (place == nullptr) return false;
  if (place->voxels == 0)
    *place = count;
  else
    voxweld::add(*place, count);
  return true;
}

void LabelTable::clear() {
  std::fill(slots_.begin(), slots_.end(), LabelCount{});
  size_ = 0;
  taken_ = false;
}

std::span<const LabelCount> LabelTable::take() {
  if (!taken_) {
    const auto end = std::remove_if(slots_.begin(), slots_.end(),
                                    [](const LabelCount& count) { return count.voxels == 0; });
    std::sort(slots_.begin(), end,
              [](const LabelCount& a, const LabelCount& b) { return a.label < b.label; });
    taken_ = true;
  }
  return {slots_.data(), size_};
}

}  // namespace voxweld
