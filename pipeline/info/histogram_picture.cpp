#include "pipeline/info/histogram_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

namespace voxweld {
namespace {

using Colour = std::array<std::uint8_t, 3>;
constexpr Colour paper{255, 255, 255}, ink{40, 40, 40}, bar{120, 140, 170}, grid{225, 225, 225};
constexpr Colour otsu_colour{200, 60, 30}, valley_colour{20, 120, 60};

// Letters of 5 x 7 dots: those that numbers and the names of the marks have.
using Glyph = std::array<std::uint8_t, 7>;  // a row each, the leftmost dot highest
const Glyph* glyph_of(char c) {
  static const std::map<char, Glyph> glyphs = {
      {'0', {14, 17, 19, 21, 25, 17, 14}}, {'1', {4, 12, 4, 4, 4, 4, 14}},
      {'2', {14, 17, 1, 2, 4, 8, 31}},     {'3', {31, 2, 4, 2, 1, 17, 14}},
      {'4', {2, 6, 10, 18, 31, 2, 2}},     {'5', {31, 16, 30, 1, 1, 17, 14}},
      {'6', {6, 8, 16, 30, 17, 17, 14}},   {'7', {31, 1, 2, 4, 8, 8, 8}},
      {'8', {14, 17, 17, 14, 17, 17, 14}}, {'9', {14, 17, 17, 15, 1, 2, 12}},
      {'.', {0, 0, 0, 0, 0, 12, 12}},      {'-', {0, 0, 0, 31, 0, 0, 0}},
      {'+', {0, 4, 4, 31, 4, 4, 0}},       {'a', {0, 0, 14, 1, 15, 17, 15}},
      {'e', {0, 0, 14, 17, 31, 16, 14}},   {'l', {12, 4, 4, 4, 4, 4, 14}},
      {'o', {0, 0, 14, 17, 17, 17, 14}},   {'s', {0, 0, 15, 16, 14, 1, 30}},
      {'t', {8, 8, 28, 8, 8, 9, 6}},       {'u', {0, 0, 17, 17, 17, 19, 13}},
      {'v', {0, 0, 17, 17, 17, 10, 4}},    {'y', {0, 17, 17, 15, 1, 17, 14}}};
  const auto found = glyphs.find(c);
  return found == glyphs.end() ? nullptr : &found->second;
}

constexpr int glyph_rows = 7, glyph_dots = 5, dot = 2;  // pixels a dot
constexpr int advance = (glyph_dots + 1) * dot, text_height = glyph_rows * dot;

class Canvas {
 public:
  Canvas(int width, int height) : picture_{width, height, {}} {
    picture_.rgb.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3,
                        paper[0]);
  }
  void fill(int x0, int y0, int x1, int y1, const Colour& colour) {
    for (int y = std::max(0, y0); y < std::min(picture_.height, y1); ++y)
      for (int x = std::max(0, x0); x < std::min(picture_.width, x1); ++x)
        std::ranges::copy(colour, picture_.rgb.begin() +
                                      (static_cast<std::ptrdiff_t>(y) * picture_.width + x) * 3);
  }
  void text(int x, int y, std::string_view words, const Colour& colour) {
    for (const char c : words) {
      if (const Glyph* glyph = glyph_of(c))
        for (int row = 0; row < glyph_rows; ++row)
          for (int column = 0; column < glyph_dots; ++column)
            if (((*glyph)[static_cast<std::size_t>(row)] >> (glyph_dots - 1 - column) & 1) != 0)
              fill(x + column * dot, y + row * dot, x + column * dot + dot, y + row * dot + dot,
                   colour);
      x += advance;
    }
  }
  HistogramPicture take() { return std::move(picture_); }

 private:
  HistogramPicture picture_;
};

// Where the bars stand, and where values lie along them.
struct Frame {
  int left = 20, top = 2 * text_height + 16, right = 0, bottom = 0;
  double begin = 0, end = 1;

  int x_of(double value) const {
    const double share = end > begin ? (value - begin) / (end - begin) : 0;
    return left + static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * (right - left)));
  }
};

void draw_bars(Canvas& canvas, const Frame& frame, const std::vector<double>& counts) {
  double highest = 1;
  for (const double count : counts) highest = std::max(highest, count);
  const auto height_of = [&](double count) {
    return static_cast<int>(
        std::lround(std::log1p(count) / std::log1p(highest) * (frame.bottom - frame.top)));
  };
  for (double count = 1; count <= highest; count *= 10)  // lines at powers of ten
    canvas.fill(frame.left, frame.bottom - height_of(count), frame.right,
                frame.bottom - height_of(count) + 1, grid);
  const auto n = static_cast<double>(counts.size());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double width = (frame.end - frame.begin) / n;
    const double lo = frame.begin + width * static_cast<double>(i);
    canvas.fill(frame.x_of(lo), frame.bottom - height_of(counts[i]),
                std::max(frame.x_of(lo) + 1, frame.x_of(lo + width)), frame.bottom, bar);
  }
}

// Round numbers along the axis, about six of them.
void draw_axis(Canvas& canvas, const Frame& frame) {
  canvas.fill(frame.left, frame.bottom, frame.right, frame.bottom + 2, ink);
  const double rough = (frame.end - frame.begin) / 6;
  const double power = std::pow(10, std::floor(std::log10(rough)));
  const double step = power * (rough / power < 2 ? 2 : rough / power < 5 ? 5 : 10);
  for (double tick = std::ceil(frame.begin / step); tick * step <= frame.end; ++tick) {
    const std::string number = fmt::format("{:.6g}", tick * step + 0.0);
    const int x = frame.x_of(tick * step);
    canvas.fill(x, frame.bottom, x + 2, frame.bottom + 6, ink);
    canvas.text(x - static_cast<int>(number.size()) * advance / 2, frame.bottom + 10, number, ink);
  }
}

struct Mark {
  const char* name;
  const std::optional<IsovalueSuggestion>& suggestion;
  const Colour& colour;
  int line;  // of text above the bars
};

void draw_mark(Canvas& canvas, const Frame& frame, const Mark& mark, int width) {
  if (!mark.suggestion) return;
  const double value = mark.suggestion->threshold.value;
  if (value < frame.begin || value > frame.end) return;
  const std::string words = fmt::format("{} {:.6g}", mark.name, value);
  const int x = frame.x_of(value), y = 4 + mark.line * (text_height + 4);
  const int length = static_cast<int>(words.size()) * advance;
  canvas.fill(x - 1, y, x + 1, frame.bottom, mark.colour);
  canvas.text(std::min(x + 6, width - length), y, words, mark.colour);
}

}  // namespace

HistogramPicture draw_histogram(const HistogramView& view, int width, int height) {
  Canvas canvas(width, height);
  Frame frame;
  frame.right = width - frame.left;
  frame.bottom = height - text_height - 16;
  frame.begin = view.cells.begin;
  frame.end = frame.begin + view.cells.width * static_cast<double>(view.cells.counts.size());
  draw_bars(canvas, frame, view.cells.counts);
  if (frame.end > frame.begin) draw_axis(canvas, frame);
  draw_mark(canvas, frame, {"otsu", view.otsu, otsu_colour, 0}, width);
  draw_mark(canvas, frame, {"valley", view.valley, valley_colour, 1}, width);
  return canvas.take();
}

}  // namespace voxweld
