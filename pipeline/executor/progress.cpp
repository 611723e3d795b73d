#include "pipeline/executor/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "pipeline/executor/memory_budget.h"

namespace voxweld {
namespace {

std::string noun_for(std::uint64_t count, std::string plural) {
  if (count == 1 && plural.ends_with("vertices"))
    plural.replace(plural.size() - 4, 4, "ex");
  else if (count == 1 && (plural.ends_with("shes") || plural.ends_with("ches")))
    plural.resize(plural.size() - 2);
  else if (count == 1 && plural.ends_with('s'))
    plural.pop_back();
  return plural;
}

constexpr int bar_width = 24;

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

ProgressSettings with_clock(ProgressSettings settings) {
  if (!settings.now) settings.now = steady_seconds;
  return settings;
}

// "build: 64 shards, 8 more done already", "encode: 12 tiles and the merged mesh".
std::string first_line(const StageStart& start) {
  const std::uint64_t units = start.units - (start.apart.empty() ? 0 : 1);
  if (start.reused > 0 && start.units == 0)
    return fmt::format("{}: {}, done already", start.stage, counted(start.reused, start.noun));
  std::string line = start.stage + ": ";
  if (units > 0 || start.apart.empty()) line += counted(units, start.noun);
  if (!start.apart.empty()) line += (units > 0 ? " and the " : "the ") + start.apart;
  if (start.reused == 0) return line;
  const std::string more = units > 0 || start.apart.empty() ? fmt::format("{} more", start.reused)
                                                            : counted(start.reused, start.noun);
  return fmt::format("{}, {} done already", line, more);
}

}  // namespace

std::string counted(std::uint64_t count, const std::string& plural) {
  return fmt::format("{} {}", count, noun_for(count, plural));
}

std::string readable_seconds(double seconds) {
  seconds = std::max(seconds, 0.0);
  if (seconds < 0.995) return fmt::format("{:.2f} s", seconds);
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

StageProgress::StageProgress(std::shared_ptr<Console> console, ProgressSettings settings,
                             StageStart start)
    : console_(std::move(console)),
      settings_(with_clock(std::move(settings))),
      start_(std::move(start)),
      begin_s_(settings_.now()),
      next_draw_s_(begin_s_) {
  if (!settings_.enabled) return;
  if (console_->terminal()) {
    refresh();
  } else {
    console_->line(first_line(start_));
    next_draw_s_ = begin_s_ + settings_.line_interval_s;
  }
  if (!settings_.redraw_by_itself) return;
  redrawing_ = std::jthread([this](const std::stop_token& stop) {
    const auto pause = std::chrono::duration<double>(std::max(settings_.bar_interval_s, 0.5));
    std::unique_lock lock(sleep_mutex_);
    while (!wake_.wait_for(lock, stop, pause, [&] { return stop.stop_requested(); })) refresh();
  });
}

StageProgress::~StageProgress() {
  stop_redrawing();
  console_->clear_status();
}

void StageProgress::stop_redrawing() {
  if (!redrawing_.joinable()) return;
  redrawing_.request_stop();
  redrawing_.join();
}

void StageProgress::unit_done(double weight, bool apart) {
  weight_done_.fetch_add(weight, std::memory_order_relaxed);
  // An executor elsewhere does not say which it was: it is not counted with the others then either.
  if (apart || (!start_.apart.empty() && units_done_ == counted_units()))
    apart_done_ = true;
  else if (++units_done_ == counted_units() && counted_units() > 1 && only_apart_left() &&
           settings_.enabled && !console_->terminal())
    console_->line(fmt::format("{}: {}", start_.stage, start_.apart));  // it may take long
  refresh();
}

// It may be as much work as all others, and then nothing else is counted on.
bool StageProgress::only_apart_left() const {
  return !start_.apart.empty() && !apart_done_ && units_done_ == counted_units();
}

void StageProgress::add_bytes(std::uint64_t bytes) {
  bytes_.fetch_add(bytes, std::memory_order_relaxed);
  refresh();
}

void StageProgress::refresh() {
  if (!settings_.enabled || settings_.now() < next_draw_s_.load(std::memory_order_relaxed)) return;
  // Workers do not queue up to draw: whoever comes second has nothing newer to show.
  const std::unique_lock lock(draw_mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return;
  const double now = settings_.now();
  if (now < next_draw_s_.load(std::memory_order_relaxed)) return;
  if (console_->terminal()) {
    console_->status(bar());
    next_draw_s_ = now + settings_.bar_interval_s;
  } else {
    console_->line(plain_line());
    next_draw_s_ = now + settings_.line_interval_s;
  }
}

void StageProgress::finish(const StageFigures& figures) {
  stop_redrawing();
  next_draw_s_ = HUGE_VAL;
  if (!settings_.enabled) return;
  console_->clear_status();
  std::string line = fmt::format("{:<8} {:>7} {:<8} {:>10}  {:>12}", start_.stage,
                                 units_done_.load(), noun_for(units_done_.load(), start_.noun),
                                 readable_seconds(figures.wall_s), rate(figures.wall_s));
  if (figures.peak_resident > 0)
    line += fmt::format("  peak {}", readable_bytes(static_cast<double>(figures.peak_resident)));
  if (!start_.apart.empty()) line += "  and the " + start_.apart;
  if (start_.reused > 0) line += fmt::format("  ({} reused)", start_.reused);
  console_->line(line);
}

double StageProgress::elapsed() const {
  return settings_.now() - begin_s_;
}

// Bytes a second where the stage counts bytes, else units a second.
std::string StageProgress::rate(double seconds) const {
  seconds = std::max(seconds, 1e-9);
  if (const std::uint64_t bytes = bytes_.load(); bytes > 0)
    return readable_bytes(static_cast<double>(bytes) / seconds) + "/s";
  const double units = static_cast<double>(units_done_.load()) / seconds;
  return fmt::format("{:.{}f} {}/s", units, units < 10 ? 1 : 0, start_.noun);
}

double StageProgress::fraction() const {
  if (start_.units == 0) return 1;
  const double done = start_.weight > 0 ? weight_done_.load() / start_.weight
                                        : static_cast<double>(units_done_ + apart_done_) /
                                              static_cast<double>(start_.units);
  return std::clamp(done, 0.0, 1.0);
}

// From the share of the work done so far; empty until there is any.
std::string StageProgress::time_left() const {
  const double done = fraction();
  if (done <= 0) return {};
  return readable_seconds(elapsed() * (1 - done) / done) + " left";
}

std::string StageProgress::bar() const {
  const double done = fraction();
  const auto filled = static_cast<std::size_t>(done * bar_width);
  std::string text = fmt::format("{:<8} [{:<{}}] {:>3.0f}%  ", start_.stage,
                                 std::string(filled, '#'), bar_width, std::floor(done * 100));
  text += only_apart_left()
              ? start_.apart
              : fmt::format("{}/{} {}", units_done_.load(), counted_units(), start_.noun);
  if (const std::string left = time_left(); !left.empty())
    text += fmt::format("  {}  {}", rate(elapsed()), left);
  return text;
}

std::string StageProgress::plain_line() const {
  const std::string what = only_apart_left() ? start_.apart
                                             : fmt::format("{} of {} {}", units_done_.load(),
                                                           counted_units(), start_.noun);
  std::string text = fmt::format("{}: {} ({:.0f}%) after {}", start_.stage, what,
                                 std::floor(fraction() * 100), readable_seconds(elapsed()));
  if (const std::string left = time_left(); !left.empty())
    text += fmt::format(", {}, {}", rate(elapsed()), left);
  return text;
}

}  // namespace voxweld
