#include "tests/paper/glyph_outline.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "storage/support/error.h"

#ifdef VOXWELD_HAS_FREETYPE
#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H
#endif

namespace voxweld::paper {

#ifdef VOXWELD_HAS_FREETYPE
namespace {

constexpr int chords = 8;

class Face {
 public:
  explicit Face(const std::filesystem::path& font) {
    if (FT_Init_FreeType(&library_) != 0) throw InputError("FreeType does not start");
    if (FT_New_Face(library_, font.c_str(), 0, &face_) == 0) return;
    FT_Done_FreeType(library_);
    throw InputError(font.string() +
                     ": no font that FreeType reads; see "
                     "tests/paper/install_packages.sh");
  }
  ~Face() {
    FT_Done_Face(face_);
    FT_Done_FreeType(library_);
  }
  Face(const Face&) = delete;
  Face& operator=(const Face&) = delete;
  FT_Face get() const { return face_; }

 private:
  FT_Library library_ = nullptr;
  FT_Face face_ = nullptr;
};

struct Collector {
  Outline outline;

  static Point2 of(const FT_Vector* v) {
    return {static_cast<double>(v->x), static_cast<double>(v->y)};
  }
  void add(Point2 p) {
    if (outline.back().empty() || outline.back().back() != p) outline.back().push_back(p);
  }
  Point2 last() const { return outline.back().back(); }
};

Point2 between(Point2 a, Point2 b, double t) {
  return {a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t};
}

int move_to(const FT_Vector* to, void* user) {
  auto& c = *static_cast<Collector*>(user);
  c.outline.emplace_back();
  c.add(Collector::of(to));
  return 0;
}
int line_to(const FT_Vector* to, void* user) {
  static_cast<Collector*>(user)->add(Collector::of(to));
  return 0;
}
int conic_to(const FT_Vector* control, const FT_Vector* to, void* user) {
  auto& c = *static_cast<Collector*>(user);
  const Point2 p = c.last(), q = Collector::of(control), r = Collector::of(to);
  for (int i = 1; i <= chords; ++i) {
    const double t = static_cast<double>(i) / chords;
    c.add(between(between(p, q, t), between(q, r, t), t));
  }
  return 0;
}
int cubic_to(const FT_Vector* first, const FT_Vector* second, const FT_Vector* to, void* user) {
  auto& c = *static_cast<Collector*>(user);
  const Point2 p = c.last(), q = Collector::of(first), r = Collector::of(second),
               s = Collector::of(to);
  for (int i = 1; i <= chords; ++i) {
    const double t = static_cast<double>(i) / chords;
    const Point2 m = between(q, r, t);
    c.add(between(between(between(p, q, t), m, t), between(m, between(r, s, t), t), t));
  }
  return 0;
}

void centre_and_scale(Outline& outline, double scale) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Point2 lo = {inf, inf}, hi = {-inf, -inf};
  for (const Contour& contour : outline)
    for (const Point2& p : contour)
      for (std::size_t a = 0; a < 2; ++a) {
        lo[a] = std::min(lo[a], p[a]);
        hi[a] = std::max(hi[a], p[a]);
      }
  for (Contour& contour : outline)
    for (Point2& p : contour)
      for (std::size_t a = 0; a < 2; ++a) p[a] = (p[a] - (lo[a] + hi[a]) / 2) * scale;
}

}  // namespace

Outline glyph_outline(const std::filesystem::path& font, char32_t character, double size) {
  const Face face(font);
  const FT_UInt glyph = FT_Get_Char_Index(face.get(), character);
  const auto code = static_cast<std::uint32_t>(character);
  if (glyph == 0)
    throw InputError(fmt::format("{}: has no character U+{:04X}", font.string(), code));
  if (FT_Load_Glyph(face.get(), glyph, FT_LOAD_NO_SCALE) != 0 ||
      face.get()->glyph->format != FT_GLYPH_FORMAT_OUTLINE)
    throw InputError(fmt::format("{}: U+{:04X} is no outline", font.string(), code));
  Collector collector;
  const FT_Outline_Funcs functions{move_to, line_to, conic_to, cubic_to, 0, 0};
  FT_Outline_Decompose(&face.get()->glyph->outline, &functions, &collector);
  for (Contour& contour : collector.outline)
    if (contour.size() > 1 && contour.front() == contour.back()) contour.pop_back();
  std::erase_if(collector.outline, [](const Contour& c) { return c.size() < 3; });
  centre_and_scale(collector.outline, size / face.get()->units_per_EM);
  return collector.outline;
}

#else

Outline glyph_outline(const std::filesystem::path&, char32_t, double) {
  throw InputError("built without FreeType: run tests/paper/install_packages.sh, then cmake again");
}

#endif

}  // namespace voxweld::paper
