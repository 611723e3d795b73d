#include "storage/vtk/xml_outline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t xml_block_bytes = std::size_t{1} << 18;
constexpr std::size_t most_markup = std::size_t{64} << 20;
constexpr std::size_t most_tag = std::size_t{1} << 20;

bool is_xml_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

class XmlScanner {
 public:
  XmlScanner(const ReadFile& file, std::string root) : file_(file), root_(std::move(root)) {}

  XmlOutline run() {
    for (;;) {
      note_text();
      const std::uint64_t begin = at_;
      const std::string tag = read_tag();
      if (tag.starts_with("<?") || tag.starts_with("<!--")) continue;
      if (tag.starts_with("<!"))
        throw FormatError(fmt::format(
            "{}: byte {}: document types and CDATA are not supported: write the file without them",
            file_.path(), begin));
      if (outline_.markup.size() + tag.size() > most_markup)
        throw FormatError(fmt::format("{}: more than {} bytes of XML tags: not a file of a volume",
                                      file_.path(), most_markup));
      if (is_start_of(tag, "AppendedData")) {
        // Whatever the tag's own end says, what follows is no XML.
        std::string closed = tag;
        if (!closed.ends_with("/>")) closed.insert(closed.size() - 1, "/");
        outline_.markup += closed + "</" + root_ + ">";
        outline_.appended = at_;
        return std::move(outline_);
      }
      outline_.markup += tag;
      if (tag.starts_with("</" + root_)) return std::move(outline_);
    }
  }

 private:
  static bool is_start_of(const std::string& tag, const std::string& name) {
    return tag.size() > name.size() + 1 && tag.compare(1, name.size(), name) == 0 &&
           (is_xml_blank(tag[name.size() + 1]) || tag[name.size() + 1] == '>' ||
            tag[name.size() + 1] == '/');
  }

  // The bytes from at_ on that are at hand, at least one; to be moved past by take().
  std::string_view ahead() {
    if (used_ == block_.size()) {
      if (at_ >= file_.size())
        throw FormatError(fmt::format(
            "{}: truncated: the file ends at byte {}, before </{}>: get a complete copy",
            file_.path(), file_.size(), root_));
      block_.resize(
          static_cast<std::size_t>(std::min<std::uint64_t>(xml_block_bytes, file_.size() - at_)));
      file_.read(at_, block_);
      used_ = 0;
    }
    return {reinterpret_cast<const char*>(block_.data()) + used_, block_.size() - used_};
  }
  void take(std::size_t count) {
    used_ += count;
    at_ += count;
  }

  // Moves on to the next '<'.
  void note_text() {
    std::optional<std::uint64_t> begin;
    for (;;) {
      const std::string_view text = ahead();
      const std::size_t end = std::min(text.find('<'), text.size());
      if (!begin) {
        const auto* first = std::find_if_not(text.data(), text.data() + end, is_xml_blank);
        if (first != text.data() + end)
          begin = at_ + static_cast<std::uint64_t>(first - text.data());
      }
      take(end);
      if (end < text.size()) break;
    }
    if (begin) outline_.markup += fmt::format("{} {}", *begin, at_);
  }

  // From '<' to its '>', which may not be the first: values of attributes may hold one.
  std::string read_tag() {
    std::string tag;
    char quote = 0;
    for (;;) {
      for (const char c : ahead()) {
        tag += c;
        take(1);
        if (ends(tag, c, quote)) return tag;
        if (tag.size() > most_tag)
          throw FormatError(fmt::format("{}: byte {}: an XML tag of more than {} bytes: damaged",
                                        file_.path(), at_ - tag.size(), most_tag));
      }
    }
  }
  // Whether c, which is the tag's last, ends it. A comment that grows is cut, its end kept.
  static bool ends(std::string& tag, char c, char& quote) {
    if (tag.starts_with("<!--")) {
      if (tag.size() > 4096) tag.erase(4, tag.size() - 8);
      return c == '>' && tag.size() >= 7 && tag.ends_with("-->");
    }
    if (tag.starts_with("<?")) return tag.ends_with("?>");
    if (quote != 0) {
      if (c == quote) quote = 0;
      return false;
    }
    if (c == '"' || c == '\'') quote = c;
    return c == '>';
  }

  const ReadFile& file_;
  std::string root_;
  XmlOutline outline_;
  std::vector<std::byte> block_;
  std::size_t used_ = 0;
  std::uint64_t at_ = 0;
};

}  // namespace

XmlOutline read_xml_outline(const ReadFile& file, const std::string& root) {
  return XmlScanner(file, root).run();
}

}  // namespace voxweld
