// The folder in which careless users work: an input, three configs, their outputs and work; and what
// clean runs of these leave.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/chaos/inputs.h"
#include "tests/fuzz/mutation.h"
#include "tests/support/watched_process.h"

namespace voxweld::testing {

// What one looks for in an output directory: name -> hash; "manifest": what the volume and the
// settings of the surface decide.
using OutputTree = std::map<std::string, std::string>;
OutputTree tree_of(const std::filesystem::path& output);
std::string tree_difference(const OutputTree& expected, const OutputTree& found);

// Where chaos is: the program, the folder below which all happens, and whether runs may go to the
// Slurm cluster that the environment names.
struct Surroundings {
  std::filesystem::path program, root;
  bool cluster = false;
};

// Takes from the cluster's queue what runs have left there, and waits until no task is alive.
void clear_queue(const Surroundings& surroundings);

// The bytes of an input file, told by a number. One that is not there: -1.
using Content = int;
inline constexpr Content no_content = -1;

// Inputs as they were, and what a clean run makes of each.
class CleanRuns {
 public:
  CleanRuns(const std::filesystem::path& program, const std::filesystem::path& folder);

  void begin(InputKind kind);  // forgets all
  InputKind kind() const { return kind_; }
  std::string input_name() const { return files_of(kind_).changing; }
  // Those of the input that stay as they are.
  void write_others(const std::filesystem::path& folder) const;
  std::size_t variants() const { return variants_of(kind_).size(); }
  Content known(const std::string& bytes);
  const std::string& bytes(Content content) const {
    return contents_.at(static_cast<std::size_t>(content));
  }
  std::size_t count() const { return contents_.size(); }
  // A volume of another solid, in the file's format.
  Content made(Random& random);
  // Nothing where such a run is refused.
  const std::optional<OutputTree>& tree(Content content, std::size_t variant);

  std::string config_text(std::size_t variant, const std::string& output,
                          const std::string& work) const;

 private:
  std::filesystem::path program_, folder_;
  InputKind kind_ = InputKind::raw;
  std::vector<std::string> contents_;
  std::map<std::string, Content> numbers_;
  std::map<std::pair<Content, std::size_t>, std::optional<OutputTree>> trees_;
};

}  // namespace voxweld::testing
