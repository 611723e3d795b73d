#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "storage/image/slice_files.h"
#include "storage/image/slice_numbers.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

struct Slice {
  fs::path path;
  NumberedName name;
};

std::string name_of(const Slice& slice) {
  return slice.path.filename().string();
}

std::vector<Slice> split_all(std::vector<fs::path> paths) {
  std::sort(paths.begin(), paths.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.native(), b.native());
  });
  std::vector<Slice> slices;
  slices.reserve(paths.size());
  for (fs::path& path : paths) {
    fs::path stem = path;
    stem.replace_extension();
    NumberedName name = split_numbers(stem.native());
    slices.push_back({std::move(path), std::move(name)});
  }
  return slices;
}

// Names of one form are slices; a few of another among them ("mask.tif") are not.
// Returns true when all names share one form.
bool check_forms(const std::vector<Slice>& slices) {
  std::map<std::string_view, std::size_t> forms;
  for (const Slice& slice : slices) ++forms[slice.name.form];
  if (forms.size() == 1) return true;
  const auto usual = std::max_element(
      forms.begin(), forms.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (usual->second == 1) return false;
  std::string odd;
  std::string example;
  std::size_t count = 0;
  for (const Slice& slice : slices) {
    if (slice.name.form == usual->first) {
      if (example.empty()) example = name_of(slice);
    } else if (++count <= 4) {
      odd += (odd.empty() ? "" : ", ") + name_of(slice);
    }
  }
  throw InputError(
      fmt::format("{}: {} images are named like {}, {} are not ({}{}); name the slices by a "
                  "pattern that leaves "
                  "the others out",
                  slices.front().path.parent_path().string(), usual->second, example, count, odd,
                  count > 4 ? ", ..." : ""));
}

std::vector<std::int64_t> column(const std::vector<Slice>& slices, std::size_t position) {
  std::vector<std::int64_t> values;
  values.reserve(slices.size());
  for (const Slice& slice : slices) values.push_back(slice.name.numbers[position]);
  return values;
}

// Positions of the numbers that are not the same in all names.
std::vector<std::size_t> varying_positions(const std::vector<Slice>& slices) {
  std::vector<std::size_t> varying;
  for (std::size_t p = 0; p < slices.front().name.numbers.size(); ++p) {
    const std::vector<std::int64_t> values = column(slices, p);
    if (std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) != values.end())
      varying.push_back(p);
  }
  return varying;
}

void sort_by(std::vector<Slice>& slices, std::size_t position) {
  std::stable_sort(slices.begin(), slices.end(), [&](const Slice& a, const Slice& b) {
    return a.name.numbers[position] < b.name.numbers[position];
  });
}

void refuse_duplicates(const std::vector<Slice>& slices, std::size_t position) {
  for (std::size_t i = 1; i < slices.size(); ++i)
    if (slices[i].name.numbers[position] == slices[i - 1].name.numbers[position])
      throw InputError(fmt::format(
          "{}: slice number {} occurs twice, in {} and {}; remove one or name the slices by a "
          "pattern",
          slices[i].path.parent_path().string(), slices[i].name.numbers[position],
          name_of(slices[i - 1]), name_of(slices[i])));
}

void check_sequence(const std::vector<Slice>& slices, std::size_t position,
                    std::vector<std::string>& warnings) {
  const NumberSequence sequence = examine_sequence(column(slices, position));
  const std::string where = slices.front().path.parent_path().string();
  if (!sequence.gaps.empty())
    throw InputError(fmt::format(
        "{}: slices are missing between {} and {}: number {}; found {} files; restore them or name "
        "an unbroken range by a pattern",
        where, name_of(slices.front()), name_of(slices.back()), describe_gaps(sequence),
        slices.size()));
  if (sequence.step != 1)
    warnings.push_back(fmt::format(
        "{}: slice numbers go up by {}; the slices are taken as neighbours", where, sequence.step));
}

// Several numbers vary (a date and a counter, say): the one that counts through is the slice
// number.
std::optional<std::size_t> find_counter(std::vector<Slice>& slices,
                                        const std::vector<std::size_t>& varying, bool& any_unique) {
  for (const std::size_t position : varying) {
    std::vector<std::int64_t> values = column(slices, position);
    std::sort(values.begin(), values.end());
    if (std::adjacent_find(values.begin(), values.end()) != values.end()) continue;
    any_unique = true;
    if (values.back() - values.front() == std::ssize(values) - 1) return position;
  }
  return std::nullopt;
}

void order_numbered(std::vector<Slice>& slices, std::vector<std::string>& warnings) {
  const std::vector<std::size_t> varying = varying_positions(slices);
  if (varying.empty()) {  // slice1 and slice01
    if (slices.size() > 1 && !slices.front().name.numbers.empty())
      refuse_duplicates(slices, slices.front().name.numbers.size() - 1);
    return;
  }
  if (varying.size() == 1) {
    sort_by(slices, varying.front());
    refuse_duplicates(slices, varying.front());
    check_sequence(slices, varying.front(), warnings);
    return;
  }
  bool any_unique = false;
  if (const auto counter = find_counter(slices, varying, any_unique)) {
    sort_by(slices, *counter);
    return;
  }
  const std::string where = slices.front().path.parent_path().string();
  if (!any_unique)
    throw InputError(
        fmt::format("{}: {} numbers vary in the file names ({}, {} ...) and none of them alone "
                    "tells the slice; "
                    "name the slices of one channel or time by a pattern",
                    where, varying.size(), name_of(slices.front()), name_of(slices[1])));
  warnings.push_back(
      fmt::format("{}: {} numbers vary in the file names and none counts through; the order is "
                  "that of the names "
                  "({}, {} ...), missing slices cannot be noticed",
                  where, varying.size(), name_of(slices.front()), name_of(slices[1])));
}

}  // namespace

SliceFiles order_slices(std::vector<fs::path> paths) {
  std::vector<Slice> slices = split_all(std::move(paths));
  SliceFiles result;
  if (check_forms(slices))
    order_numbered(slices, result.warnings);
  else
    result.warnings.push_back(fmt::format(
        "{}: the file names share no numbering; the order is that of the names ({}, {} ...), "
        "missing "
        "slices cannot be noticed",
        slices.front().path.parent_path().string(), name_of(slices.front()), name_of(slices[1])));
  for (Slice& slice : slices) result.paths.push_back(std::move(slice.path));
  return result;
}

bool natural_less(std::string_view a, std::string_view b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i, ++j;
      continue;
    }
    const auto run = [&](std::string_view text, std::size_t& at) {
      while (at < text.size() && text[at] == '0') ++at;
      const std::size_t begin = at;
      while (at < text.size() && digit(text[at])) ++at;
      return text.substr(begin, at - begin);
    };
    const std::string_view left = run(a, i), right = run(b, j);
    if (left.size() != right.size()) return left.size() < right.size();
    if (left != right) return left < right;
  }
  if (i < a.size() || j < b.size()) return i >= a.size();
  return a < b;
}

}  // namespace voxweld
