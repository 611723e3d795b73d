// The first half of an export: all tiles cut into fragments, put in the order in which they are written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "pipeline/executor/interrupt.h"
#include "pipeline/neuroglancer/segments.h"
#include "stages/encode/fragment_cut.h"
#include "storage/support/record_sorter.h"

namespace voxweld {

// Of an object at a level of detail, as its tiles have it.
struct SegmentLevel {
  std::uint64_t triangles = 0;
  double area2 = 0;  // twice the area, in lattice steps, summed in the order of tiles
};

// Records of FragmentTriangle by the object's place in the order of writing, the level and the fragment.
class FragmentSort {
 public:
  struct Source {
    const std::filesystem::path& output;
    const Manifest& manifest;
    const SegmentList& list;
    std::vector<std::size_t> order;  // of segments in the list: which is written when
    int levels = 1;                  // of detail, the mesh itself included
  };
  // scratch: a folder for what does not fit memory.
  FragmentSort(Source source, const std::filesystem::path& scratch);

  // Cuts all tiles of all levels, on many threads. FormatError or InputError for a tile that is no mesh of
  // the directory's lattice.
  void sort(int threads, const InterruptFlag* interrupt);

  struct Key {
    std::size_t segment = 0;  // in the list
    int lod = 0;
    std::uint64_t code = 0;  // fragment_code
    friend bool operator==(const Key&, const Key&) = default;
  };
  // All triangles of the next fragment. False after the last.
  bool next(Key& key, std::vector<FragmentTriangle>& triangles);

  const SegmentLevel& level(std::size_t segment, int lod) const {
    return levels_[place_[segment] * static_cast<std::size_t>(source_.levels) +
                   static_cast<std::size_t>(lod)];
  }

 private:
  struct TileWork;
  void sort_level(int lod, int threads, const InterruptFlag* interrupt);
  Key key_of(const SortKey& key) const;

  Source source_;
  std::vector<std::size_t> place_;    // of each segment, in the order of writing
  std::vector<SegmentLevel> levels_;  // by place and level
  RecordSorter sorter_;
  bool begun_ = false, more_ = false;  // a record is held that was not given yet
  SortKey held_key_;
  std::vector<std::byte> held_;
};

}  // namespace voxweld
