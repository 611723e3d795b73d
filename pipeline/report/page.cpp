#include "pipeline/report/page.h"

#include <string_view>

#include "pipeline/report/html_text.h"
#include "storage/manifest/report_file.h"

namespace voxweld {
namespace {

// Sizes go by the width of the text. Bars and pictures keep their colours on paper.
constexpr std::string_view page_style = R"css(
:root { color-scheme: light dark; --paper: #fbfaf8; --ink: #22262b; --soft: #667079;
  --line: #ddd9d2; --card: #fff; --bar: #7d94b5; --second: #b39a74; --faint: #c9ccd0;
  --iso: #e2541b; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #16191d; --ink: #e4e6e9; --soft: #99a3ad; --line: #333a42; --card: #1e2328;
    --bar: #6f8cb8; --second: #a58a5f; --faint: #4b535c; --iso: #ff7a3d; }
  figure img { filter: brightness(.88); }
}
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", sans-serif; }
main { max-width: 60rem; margin: 0 auto; padding: 2rem 1.25rem 3rem; }
header { margin-bottom: 1.5rem; }
h1 { font-size: 1.75rem; line-height: 1.2; margin: 0 0 .35rem; overflow-wrap: anywhere; }
h2 { font-size: 1.15rem; margin: 2.25rem 0 .6rem; padding-bottom: .3rem;
  border-bottom: 1px solid var(--line); }
p { margin: 0 0 .75rem; max-width: 46rem; }
header p, .intro, figcaption, footer { color: var(--soft); }
.intro, footer { font-size: .9rem; }
.three { display: grid; grid-template-columns: repeat(3, minmax(0, 1fr)); gap: 1rem;
  align-items: start; }
figure { margin: 0; }
figure img, svg.slice { display: block; width: 100%; height: auto; border-radius: 6px;
  border: 1px solid var(--line); }
svg.slice { max-height: 34rem; background: #000; }
figcaption { font-size: .8rem; line-height: 1.4; margin-top: .4rem; }
figcaption b { color: var(--ink); }
.iso { fill: none; stroke: var(--iso); stroke-width: 1.4; stroke-linejoin: round; }
.chart { position: relative; height: 14rem; margin: 2rem 0 2rem; }
.chart svg { display: block; width: 100%; height: 100%; border-bottom: 1px solid var(--soft); }
.bars { fill: var(--bar); }
.tick, .mark { position: absolute; font-size: .8rem; white-space: nowrap; line-height: 1; }
.tick { top: 100%; margin-top: .4rem; transform: translateX(-50%); color: var(--soft); }
.mark { bottom: 100%; margin-bottom: .35rem; color: var(--iso); font-weight: 600; }
.mark.left { transform: translateX(-100%); }
.nodes { margin: .75rem 0 1rem; }
.node { display: flex; align-items: center; gap: .6rem; margin: 2px 0; break-inside: avoid; }
.node > span { flex: 0 0 7rem; overflow: hidden; text-overflow: ellipsis; white-space: nowrap;
  font-size: .8rem; line-height: 1.1; color: var(--soft); text-align: right; }
.node > svg, .node > div { flex: 1; min-width: 0; }
.node > svg { display: block; background: var(--card); outline: 1px solid var(--line); }
.node .failed { fill: #c8321f; }
.axis > div { position: relative; height: 1.4rem; }
.axis .tick { margin-top: 0; top: .2rem; }
.axis .tick:first-child { transform: none; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: .92rem; }
th, td { text-align: left; padding: .32rem .75rem .32rem 0; vertical-align: top;
  border-bottom: 1px solid var(--line); font-weight: 400; }
.facts th { color: var(--soft); width: 30%; min-width: 8rem; }
.facts td { overflow-wrap: anywhere; }
.wide { white-space: nowrap; }
.wide thead th { color: var(--soft); font-size: .85rem; }
th.num, td.num { text-align: right; font-variant-numeric: tabular-nums; }
td.bar { width: 22%; min-width: 4rem; vertical-align: middle; }
td.bar span { display: block; height: .6rem; border-radius: 2px; background: var(--bar); }
td.bar .second { background: var(--second); }
td.bar .faint { background: var(--faint); }
.swatch { display: inline-block; width: .8em; height: .8em; border-radius: 2px; margin-right: .5em; }
code, pre { font: .85rem/1.45 ui-monospace, SFMono-Regular, Consolas, "Liberation Mono", monospace; }
details { margin-top: .75rem; }
summary { cursor: pointer; overflow-wrap: anywhere; }
pre { background: var(--card); border: 1px solid var(--line); border-radius: 6px; padding: .75rem;
  overflow-x: auto; }
ul { margin: 0; padding-left: 1.2rem; }
footer { margin-top: 2.5rem; padding-top: .75rem; border-top: 1px solid var(--line); }
@media (max-width: 40rem) {
  .three { grid-template-columns: 1fr; }
  main { padding: 1.25rem .9rem 2rem; }
  .facts, .facts tbody, .facts tr, .facts th, .facts td { display: block; width: auto; }
  .facts th { border: 0; padding-bottom: 0; font-size: .85rem; }
  .facts td { padding-top: 0; }
  .wide th, .wide td { padding-right: .5rem; }
  td.bar { min-width: 1.5rem; }
}
@media print {
  :root { --paper: #fff; --ink: #000; --soft: #444; --line: #ccc; --card: #fff; --bar: #7d94b5;
    --second: #b39a74; --faint: #c9ccd0; --iso: #d0470f; }
  body { font-size: 10.5pt; }
  main { max-width: none; padding: 0; }
  h2 { break-after: avoid; }
  figure, tr, .chart { break-inside: avoid; }
  .three { grid-template-columns: repeat(3, minmax(0, 1fr)); }
  pre { white-space: pre-wrap; overflow-wrap: anywhere; }
  @page { margin: 16mm; }
}
)css";

}  // namespace

std::string page_html(const Page& page) {
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  html += std::string(report_mark) + escaped(page.key) + "\">\n";
  html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
          escaped(page.title) + "</title>\n<style>" + std::string(page_style) +
          "</style>\n</head>\n<body>\n<main>\n<header>\n<h1>" + escaped(page.title) + "</h1>\n<p>" +
          escaped(page.lede) + "</p>\n</header>\n";
  for (const PageSection& section : page.sections) {
    if (section.html.empty()) continue;
    html += "<section>\n<h2>" + escaped(section.title) + "</h2>\n";
    if (!section.intro.empty()) html += "<p class=\"intro\">" + escaped(section.intro) + "</p>\n";
    html += section.html + "</section>\n";
  }
  return html + "<footer>" + escaped(page.footer) + "</footer>\n</main>\n</body>\n</html>\n";
}

std::string key_of_page(const std::string& beginning) {
  const auto at = beginning.find(report_mark);
  if (at == std::string::npos) return {};
  const auto begin = at + report_mark.size();
  const auto end = beginning.find('"', begin);
  return end == std::string::npos ? std::string() : beginning.substr(begin, end - begin);
}

}  // namespace voxweld
