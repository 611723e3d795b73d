// A small volume, all stages but encode done, and jobs for encode to do anew, in this process.
#pragma once

#include <algorithm>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/run/jobs.h"
#include "pipeline/run/run.h"
#include "tests/support/temp_directory.h"

namespace voxweld::testing {

class EncodedScene {
 public:
  // settings: as of --set, beside the volume's own. A ball of radius 18 in 40^3 samples.
  explicit EncodedScene(std::vector<std::string> settings = {}) {
    write_ball();
    settings.push_back("work.brick=16");
    context_.config = parse_config(
        "[input]\npath = \"ball.raw\"\nformat = \"raw\"\nsize = [40, 40, 40]\ntype = \"uint8\"\n"
        "[surface]\nisovalue = 127.5\n",
        directory_ / "scene.toml", settings);
    context_.executor = &executor_;
    ConsoleSettings to;
    to.write = [this](std::string_view text) { shown_ += text; };
    context_.console = std::make_shared<Console>(to);
    context_.threads = 2;
    run_all(context_);
    jobs_ = std::make_unique<Jobs>(context_.config);
    jobs_->open_volume(context_.config);
  }

  RunContext& context() { return context_; }
  std::filesystem::path output(const std::string& name) const { return directory_ / name; }
  // The run's own, into a directory of that name.
  EncodeJob job(const std::string& name) const {
    EncodeJob job = jobs_->encode();
    job.folder = directory_ / (name + ".records");
    job.output = output(name);
    return job;
  }
  void encode(const EncodeJob& job) {
    context_.reports.clear();
    shown_.clear();
    const TopArtifact top(job.stitch->merge->path());
    const auto plan = unit_plan(top, context_.config.labels.mode);
    const auto work = encode_stage({context_.config, job, top.content_hash(), *plan, nullptr,
                                    [&] { return make_manifest(context_, *jobs_, top, {}); }});
    do_stage(context_, *work);
  }
  const std::string& shown() const { return shown_; }

 private:
  void write_ball() const {
    std::ofstream out(directory_ / "ball.raw", std::ios::binary);
    for (int z = 0; z < 40; ++z)
      for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 40; ++x) {
          const int dx = x - 20, dy = y - 20, dz = z - 19;
          out.put(static_cast<char>(std::max(0, 255 - (dx * dx + dy * dy + dz * dz) * 128 / 324)));
        }
  }

  TempDirectory directory_;
  LocalExecutor executor_;
  RunContext context_;
  std::string shown_;
  std::unique_ptr<Jobs> jobs_;
};

}  // namespace voxweld::testing
