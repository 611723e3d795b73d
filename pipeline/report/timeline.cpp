#include "pipeline/report/timeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "pipeline/report/histogram_chart.h"
#include "pipeline/report/html_text.h"

namespace voxweld {
namespace {

constexpr std::size_t most_nodes = 40;  // that are drawn
constexpr int chart_columns = 2000;     // of the chart: what is narrower is drawn as one
constexpr long failed_columns = 8;      // those that failed are to be seen
constexpr double least_lane = 5, most_height = 60;  // pixels

struct Placed {
  const TaskTime* task = nullptr;
  std::size_t lane = 0;  // of its node: tasks that run at the same time lie in different ones
};

struct NodeRow {
  std::string name;
  std::vector<Placed> tasks;  // those that ran, by their beginning
  std::size_t lanes = 0;
  double busy = 0;
};

// Each task goes into the first lane that is free.
void place_tasks(NodeRow& row) {
  std::ranges::stable_sort(row.tasks, {}, [](const Placed& p) { return p.task->began; });
  std::vector<double> free_from;
  for (Placed& placed : row.tasks) {
    const auto lane = std::ranges::find_if(
        free_from, [&](double from) { return from <= placed.task->began + 1e-3; });
    placed.lane = static_cast<std::size_t>(lane - free_from.begin());
    if (lane == free_from.end()) free_from.push_back(0);
    free_from[placed.lane] = placed.task->ended;
    row.busy += placed.task->ended - placed.task->began;
  }
  row.lanes = std::max<std::size_t>(1, free_from.size());
}

std::vector<NodeRow> rows_of(std::span<const TaskTime> tasks) {
  std::map<std::string, NodeRow> by_name;
  for (const TaskTime& task : tasks) by_name[task.node].tasks.push_back({&task});
  std::vector<NodeRow> rows;
  for (auto& [name, row] : by_name) {
    row.name = name.empty() ? "unknown" : name;
    place_tasks(row);
    rows.push_back(std::move(row));
  }
  return rows;
}

struct TimeSpan {
  double begin = 0, end = 0;
  double length() const { return end - begin; }
  double share(double time) const {
    return length() > 0 ? std::clamp((time - begin) / length(), 0.0, 1.0) : 0;
  }
};

TimeSpan span_of(std::span<const TaskTime> tasks) {
  TimeSpan span{tasks.front().submitted, tasks.front().ended};
  for (const TaskTime& task : tasks) {
    span.begin = std::min({span.begin, task.submitted, task.began});
    span.end = std::max(span.end, task.ended);
  }
  return span;
}

// In the order in which they were submitted.
std::vector<std::string> stages_of(std::span<const TaskTime> tasks) {
  std::vector<std::string> stages;
  for (const TaskTime& task : tasks)
    if (std::ranges::find(stages, task.stage) == stages.end()) stages.push_back(task.stage);
  return stages;
}

// Neighbours differ in hue and in lightness, so that they can be told apart on grey paper too.
std::string colour_of(std::size_t stage) {
  constexpr std::array<int, 5> hues = {215, 35, 160, 280, 100};
  return fmt::format("hsl({},{}%,{}%)", hues[stage % hues.size()], 42, stage % 2 == 0 ? 48 : 66);
}

std::string time_text(double seconds) {
  if (seconds < 100) return fmt::format("{:.1f} s", seconds);
  if (seconds < 5400) return fmt::format("{:.1f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

std::string percent(double part, double all) {
  return all > 0 ? fmt::format("{:.0f} %", 100 * std::clamp(part / all, 0.0, 1.0)) : "";
}

// One path for the tasks of a stage, or for those that failed. least: so many columns each has.
template <class Keep>
std::string bars(const NodeRow& row, const TimeSpan& span, long least, Keep&& keep) {
  std::string path;
  std::set<std::pair<std::size_t, long>> drawn;  // narrow ones, by lane and place
  for (const auto& [task, lane] : row.tasks) {
    if (!keep(*task)) continue;
    const long from = std::lround(chart_columns * span.share(task->began));
    const long wide = std::max(least, std::lround(chart_columns * span.share(task->ended)) - from);
    if (wide == least && !drawn.emplace(lane, from).second) continue;
    path += fmt::format("M{} {}.1h{}v.8h-{}z", from, lane, wide, wide);
  }
  return path;
}

std::string row_html(const NodeRow& row, const TimeSpan& span,
                     const std::vector<std::string>& stages) {
  std::string paths;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const std::string path = bars(row, span, 1, [&](const TaskTime& task) {
      return task.stage == stages[i] && !task.failed && !task.lost;
    });
    if (!path.empty()) paths += fmt::format("<path fill=\"{}\" d=\"{}\"/>", colour_of(i), path);
  }
  const std::string failed = bars(row, span, failed_columns,
                                  [](const TaskTime& task) { return task.failed || task.lost; });
  if (!failed.empty()) paths += fmt::format("<path class=\"failed\" d=\"{}\"/>", failed);
  const double tall =
      std::clamp(least_lane * static_cast<double>(row.lanes), 2 * least_lane, most_height);
  return fmt::format(
      "<div class=\"node\"><span>{}</span><svg style=\"height:{:.0f}px\" viewBox=\"0 0 {} {}\" "
      "preserveAspectRatio=\"none\" role=\"img\" aria-label=\"Tasks of {}\">{}</svg></div>\n",
      escaped(row.name), tall, chart_columns, row.lanes, escaped(row.name), paths);
}

// Of the chart's width: an axis in the unit that fits.
std::string axis_html(const TimeSpan& span) {
  const double unit = span.length() < 300 ? 1 : span.length() < 3 * 3600 ? 60 : 3600;
  const char* name = unit == 1 ? "s" : unit == 60 ? "min" : "h";
  std::string html = "<div class=\"node axis\"><span></span><div>";
  for (const double tick : round_ticks(0, span.length() / unit, 6)) {
    const double at = 100 * tick * unit / span.length();
    if (at > 97) continue;  // it would reach over the edge
    html += fmt::format("<span class=\"tick\" style=\"left:{:.2f}%\">{} {}</span>", at,
                        short_number(tick), name);
  }
  return html + "</div></div>\n";
}

struct StageSum {
  std::size_t tasks = 0, again = 0, failed = 0;
  double busy = 0;
};

std::string stage_rows(std::span<const TaskTime> tasks, const std::vector<std::string>& stages,
                       std::size_t lanes) {
  std::string html =
      "<div class=\"scroll\">\n<table class=\"wide\">\n<thead><tr><th>Stage</th><th "
      "class=\"num\">Tasks</th><th class=\"num\">Failed or lost</th><th class=\"num\">Submitted "
      "again</th><th class=\"num\">Time of tasks</th><th class=\"num\">From first to last</th><th "
      "class=\"num\">Waiting</th></tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < stages.size(); ++i) {
    StageSum sum;
    std::vector<TaskTime> own;
    for (const TaskTime& task : tasks) {
      if (task.stage != stages[i]) continue;
      own.push_back(task);
      ++sum.tasks;
      sum.again += task.again ? 1 : 0;
      sum.failed += task.failed || task.lost ? 1 : 0;
      sum.busy += task.ended - task.began;
    }
    const double length = span_of(own).length(), room = static_cast<double>(lanes) * length;
    html += fmt::format(
        "<tr><td><span class=\"swatch\" style=\"background:{}\"></span>{}</td><td "
        "class=\"num\">{}</td><td class=\"num\">{}</td><td class=\"num\">{}</td><td "
        "class=\"num\">{}</td><td class=\"num\">{}</td><td class=\"num\">{}</td></tr>\n",
        colour_of(i), escaped(stages[i]), sum.tasks, sum.failed, sum.again, time_text(sum.busy),
        time_text(length), percent(room - sum.busy, room));
  }
  return html + "</tbody>\n</table>\n</div>\n";
}

std::string intro_of(std::span<const TaskTime> tasks, const std::vector<NodeRow>& rows,
                     const TimeSpan& span) {
  std::size_t failed = 0, lost = 0, again = 0, lanes = 0;
  double busy = 0;
  for (const TaskTime& task : tasks) {
    failed += task.failed ? 1 : 0;
    lost += task.lost ? 1 : 0;
    again += task.again ? 1 : 0;
  }
  for (const NodeRow& row : rows) {
    lanes += row.lanes;
    busy += row.busy;
  }
  const double room = static_cast<double>(lanes) * span.length();
  std::string text = fmt::format(
      "{} on {}, {} from the first submission to the last end. {} of the time of the nodes (as "
      "many "
      "tasks at a time as each ever had) went to waiting: in the queue, for the last task of a "
      "stage, or for work between stages.",
      grouped(tasks.size(), "tasks"), grouped(rows.size(), "nodes"), time_text(span.length()),
      percent(room - busy, room));
  if (failed + lost > 0)
    text += fmt::format(" {} failed and {} left no report; they are red.", failed, lost);
  if (again > 0)
    text += fmt::format(" {} did what others had left undone.", grouped(again, "tasks"));
  if (rows.size() > most_nodes)
    text += fmt::format(" The {} nodes that worked most are drawn.", most_nodes);
  return text;
}

}  // namespace

Timeline timeline(std::span<const TaskTime> tasks) {
  if (tasks.empty()) return {};
  std::vector<NodeRow> rows = rows_of(tasks);
  const TimeSpan span = span_of(tasks);
  const std::vector<std::string> stages = stages_of(tasks);
  std::size_t lanes = 0;
  for (const NodeRow& row : rows) lanes += row.lanes;
  Timeline timeline;
  timeline.intro = intro_of(tasks, rows, span);
  if (rows.size() > most_nodes) {
    std::ranges::stable_sort(rows, std::greater(), &NodeRow::busy);
    rows.resize(most_nodes);
    std::ranges::sort(rows, {}, &NodeRow::name);
  }
  timeline.html = "<div class=\"nodes\">\n";
  for (const NodeRow& row : rows) timeline.html += row_html(row, span, stages);
  timeline.html += axis_html(span) + "</div>\n" + stage_rows(tasks, stages, lanes);
  return timeline;
}

}  // namespace voxweld
