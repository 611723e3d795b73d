// A cluster made of shell scripts: sbatch, squeue and scancel in a directory that is first on PATH
// while it lives. Each script notes its arguments in calls().
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "pipeline/slurm/slurm_client.h"
#include "tests/support/temp_directory.h"

namespace voxweld::testing {

class FakeSlurm {
 public:
  FakeSlurm() : path_before_(std::getenv("PATH")) {
    setenv("PATH", (directory_.path().string() + ":" + path_before_).c_str(), 1);
    for (const char* name : {"sbatch", "squeue", "scancel"}) program(name, "exit 0");
  }
  ~FakeSlurm() { setenv("PATH", path_before_.c_str(), 1); }
  FakeSlurm(const FakeSlurm&) = delete;
  FakeSlurm& operator=(const FakeSlurm&) = delete;

  // `lines` of shell; $n counts the calls of this program from 1, $dir is a place for files.
  void program(const std::string& name, const std::string& lines) {
    const auto file = directory_ / name;
    std::ofstream(file) << "#!/bin/bash\ndir='" << directory_.path().string() << "'\n"
                        << "echo \"" << name << " $*\" >>\"$dir/calls\"\n"
                        << "n=$(grep -c '^" << name << " ' \"$dir/calls\")\n"
                        << lines << "\n";
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }

  // One line a call: the program and its arguments.
  std::vector<std::string> calls() const {
    std::ifstream file(directory_ / "calls");
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
  }
  std::size_t calls_of(const std::string& name) const {
    std::size_t count = 0;
    for (const std::string& line : calls()) count += line.starts_with(name + " ") ? 1 : 0;
    return count;
  }

  std::filesystem::path path() const { return directory_.path(); }

 private:
  TempDirectory directory_;
  std::string path_before_;
};

// sbatch and squeue of a cluster where nothing ever starts: what is submitted is pending, one
// task a line of the file "queue" in slurm.path(), as slurm_text::task_format has them; ids from
// 101.
inline void give_queue(FakeSlurm& slurm) {
  slurm.program("sbatch", R"(for word in "$@"; do
  case $word in --job-name=*) name=${word#*=} ;; esac
done
last=$(sed -n 's/^#SBATCH --array=0-\([0-9]*\).*/\1/p' "${@: -1}")
for task in $(seq 0 "$last"); do
  echo "$((100 + n))|$task|PENDING||$name|Resources" >>"$dir/queue"
done
echo $((100 + n)))");
  slurm.program("squeue", R"(ids='' names='' states=all
while [ $# -gt 0 ]; do
  case $1 in
    -j) ids=,$2, ;;
    -t) states=$2 ;;
    --name=*) names=,${1#*=}, ;;
  esac
  shift
done
touch "$dir/queue"
while IFS='|' read -r job task state node name reason; do
  [ -z "$ids" ] || [[ $ids = *",$job,"* ]] || continue
  [ -z "$names" ] || [[ $names = *",$name,"* ]] || continue
  [ "$states" = all ] || [ "$states" = "$state" ] || continue
  echo "$job|$task|$state|$node|$name|$reason"
done <"$dir/queue"
exit 0)");
}

// Does not wait between tries; counts how long it would have.
struct NoWaiting {
  std::chrono::milliseconds waited{0};
  SlurmClientOptions options() {
    SlurmClientOptions options;
    options.sleep = [this](std::chrono::milliseconds time) { waited += time; };
    return options;
  }
};

inline const std::string unreachable = "Unable to contact slurm controller (connect failure)";

}  // namespace voxweld::testing
