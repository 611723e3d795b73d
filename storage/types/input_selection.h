// Which volume of a file or folder that holds several, as the user says it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace voxweld {

// Which of the things that a file can hold several of is one.
enum class Selector : std::uint8_t { dataset, series, level, channel, time };
inline constexpr std::array selectors{Selector::dataset, Selector::series, Selector::level,
                                      Selector::channel, Selector::time};
constexpr const char* selector_name(Selector selector) {
  constexpr const char* names[] = {"dataset", "series", "level", "channel", "time"};
  return names[static_cast<std::size_t>(selector)];
}

// Which volume of a file or folder that holds several. What is left open is taken where there is
// one only, and of levels the finest. Else the reader refuses the input and lists what there is.
struct InputSelection {
  std::string dataset{};                  // an array inside the file, or a grid: its path or name
  std::string series{};                   // of DICOM: the UID, or the number that `info` lists
  std::optional<std::int64_t> level{};    // of a pyramid of resolutions; 0: the finest
  std::optional<std::int64_t> channel{};  // from 0
  std::optional<std::int64_t> time{};     // from 0

  bool has(Selector selector) const;
  friend bool operator==(const InputSelection&, const InputSelection&) = default;
};

// What is done with slices that are not equally far apart.
enum class Resample : std::uint8_t { none, uniform };  // refused; interpolated at equal distances

}  // namespace voxweld
