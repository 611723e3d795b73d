#include "pipeline/executor/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <thread>
#include <vector>

#include "pipeline/executor/executor.h"
#include "pipeline/executor/log.h"

namespace voxweld {
namespace {

using testing::HasSubstr;

// What a user would see, and a clock that stands still until told.
struct Screen {
  std::string written;
  double now = 100;
  std::shared_ptr<Console> console;
  ProgressSettings settings;

  explicit Screen(bool terminal, int columns = 80) {
    ConsoleSettings to;
    to.write = [this](std::string_view text) { written += text; };
    to.terminal = terminal;
    to.columns = [columns] { return columns; };
    console = std::make_shared<Console>(to);
    settings.now = [this] { return now; };
    settings.redraw_by_itself = false;
  }

  std::string take() { return std::exchange(written, {}); }
};

StageFigures figures_of(double wall_s) {
  StageFigures figures;
  figures.wall_s = wall_s;
  figures.peak_resident = 210 << 20;
  return figures;
}

TEST(Progress, PlainLinesAreSparse) {
  Screen screen(false);
  StageProgress progress(screen.console, screen.settings, {"build", "shards", 100, 0, 0});
  EXPECT_EQ(screen.take(), "build: 100 shards\n");
  for (int i = 0; i < 39; ++i) {
    screen.now += 0.125;
    progress.unit_done(1);
  }
  EXPECT_EQ(screen.take(), "");
  screen.now += 0.125;
  progress.unit_done(1);
  EXPECT_EQ(screen.take(), "build: 40 of 100 shards (40%) after 5.0 s, 8.0 shards/s, 7.5 s left\n");
  progress.unit_done(1);
  EXPECT_EQ(screen.take(), "");
  progress.finish(figures_of(1.2));
  EXPECT_THAT(screen.take(), HasSubstr("build         41 shards        1.2 s"));
}

TEST(Progress, BarIsRedrawnInPlaceAndLeavesTheSummary) {
  Screen screen(true);
  StageProgress progress(screen.console, screen.settings, {"build", "shards", 4, 8, 2});
  EXPECT_EQ(screen.take(), "\r\x1b[Kbuild    [                        ]   0%  0/4 shards");
  screen.now += 2;
  progress.unit_done(4);
  EXPECT_EQ(
      screen.take(),
      "\r\x1b[Kbuild    [############            ]  50%  1/4 shards  0.5 shards/s  2.0 s left");
  screen.now += 0.05;
  progress.unit_done(1);
  EXPECT_EQ(screen.take(), "") << "drawn less than bar_interval_s ago";
  progress.add_bytes(std::uint64_t{4} << 30);
  progress.finish(figures_of(2));
  EXPECT_EQ(screen.take(),
            "\r\x1b[K"
            "build          2 shards        2.0 s     2.0 GiB/s  peak 210.0 MiB  (2 reused)\n");
}

TEST(Progress, LogLinesGoAboveTheBar) {
  Screen screen(true);
  StageProgress progress(screen.console, screen.settings, {"build", "shards", 4, 0, 0});
  const std::string bar = screen.take().substr(4);
  screen.console->line("warning: assumed millimetres");
  EXPECT_EQ(screen.take(), "\r\x1b[Kwarning: assumed millimetres\n" + bar);
}

TEST(Progress, AFailedStageTakesItsBarAway) {
  Screen screen(true);
  { const StageProgress progress(screen.console, screen.settings, {"build", "shards", 4, 0, 0}); }
  EXPECT_THAT(screen.take(), testing::EndsWith("\r\x1b[K"));
}

TEST(Progress, BarIsCutToTheTerminal) {
  Screen screen(true, 20);
  const StageProgress progress(screen.console, screen.settings, {"build", "shards", 4, 0, 0});
  EXPECT_EQ(screen.take(), "\r\x1b[Kbuild    [         ");
}

// The merged mesh is no tile, and may take as long as all of them.
TEST(Progress, NamesTheUnitThatIsApart) {
  Screen screen(false);
  StageProgress progress(screen.console, screen.settings,
                         {"encode", "tiles", 3, 8, 0, "merged mesh"});
  EXPECT_EQ(screen.take(), "encode: 2 tiles and the merged mesh\n");
  screen.now += 1;
  progress.unit_done(2);
  EXPECT_EQ(screen.take(), "");
  progress.unit_done(2);
  EXPECT_EQ(screen.take(), "encode: merged mesh\n");
  screen.now += 7;
  progress.refresh();
  EXPECT_EQ(screen.take(), "encode: merged mesh (50%) after 8.0 s, 0.2 tiles/s, 8.0 s left\n");
  progress.unit_done(4, true);
  progress.finish(figures_of(9));
  EXPECT_EQ(screen.take(),
            "encode         2 tiles         9.0 s   0.2 tiles/s  peak 210.0 MiB  and the merged "
            "mesh\n");
}

TEST(Progress, ShowsTheUnitThatIsApartInTheBar) {
  Screen screen(true);
  StageProgress progress(screen.console, screen.settings,
                         {"encode", "tiles", 2, 0, 5, "merged mesh"});
  EXPECT_THAT(screen.take(), HasSubstr("  0%  0/1 tiles"));
  screen.now += 1;
  progress.unit_done(1);
  EXPECT_THAT(screen.take(), HasSubstr(" 50%  merged mesh  1.0 tiles/s"));
}

TEST(Progress, CountsOneAsOne) {
  EXPECT_EQ(counted(1, "tiles"), "1 tile");
  EXPECT_EQ(counted(2, "tiles"), "2 tiles");
  EXPECT_EQ(counted(0, "meshes"), "0 meshes");
  EXPECT_EQ(counted(1, "meshes"), "1 mesh");
  EXPECT_EQ(counted(1, "batches"), "1 batch");
  EXPECT_EQ(counted(1, "vertices"), "1 vertex");
}

TEST(Progress, DisabledSaysNothing) {
  for (const bool terminal : {false, true}) {
    Screen screen(terminal);
    screen.settings.enabled = false;
    {
      StageProgress progress(screen.console, screen.settings, {"build", "shards", 1, 0, 0});
      screen.now += 100;
      progress.unit_done(1);
      progress.finish(figures_of(1));
    }
    EXPECT_EQ(screen.take(), "");
  }
}

TEST(Progress, CountsWhatManyThreadsReportWhileItRedrawsItself) {
  Screen screen(true);
  screen.settings = ProgressSettings{};
  screen.settings.bar_interval_s = 0;
  StageProgress progress(screen.console, screen.settings, {"build", "shards", 2000, 0, 0});
  std::vector<Unit> units(2000);
  RunOptions options;
  options.threads = 4;
  options.progress = &progress;
  LocalExecutor().run_units(
      "build", units, [](const Unit&, WorkerContext& context) { context.add_bytes(1 << 20); },
      options);
  progress.finish(figures_of(1));
  EXPECT_THAT(screen.take(), HasSubstr("build       2000 shards        1.0 s     2.0 GiB/s"));
}

TEST(Progress, WritesTimesForPeople) {
  EXPECT_EQ(readable_seconds(0.42), "0.42 s");
  EXPECT_EQ(readable_seconds(1.24), "1.2 s");
  EXPECT_EQ(readable_seconds(59.4), "59 s");
  EXPECT_EQ(readable_seconds(59.6), "1 min 00 s");
  EXPECT_EQ(readable_seconds(185), "3 min 05 s");
  EXPECT_EQ(readable_seconds(7625), "2 h 07 min");
}

TEST(Log, LevelsDecideWhatIsWritten) {
  const auto before = spdlog::default_logger();
  const auto lines_at = [](LogLevel level) {
    Screen screen(false);
    set_up_logging(level, screen.console);
    spdlog::debug("d {}", 1);
    spdlog::info("i");
    spdlog::warn("w");
    spdlog::error("e");
    return screen.take();
  };
  EXPECT_EQ(lines_at(LogLevel::quiet), "error: e\n");
  EXPECT_EQ(lines_at(LogLevel::warning), "warning: w\nerror: e\n");
  EXPECT_EQ(lines_at(LogLevel::info), "i\nwarning: w\nerror: e\n");
  EXPECT_EQ(lines_at(LogLevel::debug), "debug: d 1\ni\nwarning: w\nerror: e\n");
  spdlog::set_default_logger(before);
  EXPECT_EQ(parse_log_level("quiet"), LogLevel::quiet);
  EXPECT_FALSE(parse_log_level("loud").has_value());
  EXPECT_FALSE(shows_progress(LogLevel::warning));
  EXPECT_TRUE(shows_progress(LogLevel::info));
}

}  // namespace
}  // namespace voxweld
