#include "pipeline/config/edit_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "pipeline/config/document.h"
#include "pipeline/config/edit_settings.h"
#include "pipeline/config/item_reader.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// Of the line that holds the byte `at`; its end is behind its last character but the line break.
std::size_t line_begin(const std::string& text, std::size_t at) {
  const auto before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  return before == std::string::npos ? 0 : before + 1;
}
std::size_t line_end(const std::string& text, std::size_t at) {
  const auto end = text.find('\n', at);
  if (end == std::string::npos) return text.size();
  return end > 0 && end > line_begin(text, at) && text[end - 1] == '\r' ? end - 1 : end;
}
std::size_t next_line(const std::string& text, std::size_t at) {
  const auto end = text.find('\n', at);
  return end == std::string::npos ? text.size() : end + 1;
}

// The first character of the line that begins there which is no white space; 0: none.
char first_character(const std::string& text, std::size_t line) {
  const auto at = text.find_first_not_of(" \t", line);
  return at == std::string::npos || at >= line_end(text, line) ? '\0' : text[at];
}
bool is_blank(const std::string& text, std::size_t line) {
  return first_character(text, line) == '\0';
}

// The line `begin` or, where a comment directly above belongs to it, that comment's first line.
std::size_t with_comment(const std::string& text, std::size_t begin) {
  std::size_t comment = begin;
  while (comment > 0 && first_character(text, line_begin(text, comment - 1)) == '#')
    comment = line_begin(text, comment - 1);
  const bool apart = comment > 0 && is_blank(text, line_begin(text, comment - 1));
  return apart ? comment : begin;
}

// All a text says but one edit, those behind it counted without it. Number 0: all it says.
std::vector<std::string> said_beside(const std::string& text, std::size_t number) {
  std::vector<std::string> said;
  for (const DocumentEntry& entry : parse_document(text, "changed text")) {
    const bool of_edits = number > 0 && entry.table == edit_table;
    if (of_edits && entry.item == number) continue;
    const std::size_t item = of_edits && entry.item > number ? entry.item - 1 : entry.item;
    said.push_back(fmt::format("{} {} {} {}", entry.table, item, entry.key, to_toml(entry.value)));
  }
  return said;
}

// Nothing but the one edit may have changed its meaning. A bug in us if it has.
void check_same(const std::vector<std::string>& before, const std::vector<std::string>& after) {
  if (before != after) throw std::logic_error("a change of an edit would change other keys too");
}

std::string key_line(const std::string& key, const std::string& value) {
  return key + " = " + value;
}

}  // namespace

std::size_t EditText::Edit::last() const {
  std::size_t last = header;
  for (const Key& key : keys) last = std::max(last, key.end);
  return last;
}

const EditText::Key* EditText::Edit::find(const std::string& name) const {
  const auto found = std::find_if(keys.begin(), keys.end(),
                                  [&](const EditText::Key& key) { return key.name == name; });
  return found == keys.end() ? nullptr : &*found;
}

EditText::EditText(std::string text, std::string file)
    : text_(std::move(text)), file_(std::move(file)), edits_(locate()) {}

std::vector<EditText::Edit> EditText::locate() const {
  std::vector<Edit> edits;
  for (const DocumentEntry& entry : parse_document(text_, file_)) {
    if (!is_of_items(edit_table, entry)) continue;
    const std::size_t at = offset_of(text_, entry.key_at);
    const std::size_t value = offset_of(text_, entry.value_at);
    const std::string where = place_text(file_, entry.key_at);
    if (entry.item == 0 || (entry.key.empty() && text_[at] != '['))
      throw InputError(where +
                       ": edits can be changed only where each is a table [[edit]]; write them so, "
                       "or change them by hand");
    if (entry.key.empty()) {
      edits.push_back({at, {}});
      continue;
    }
    const bool table = std::holds_alternative<UnusableValue>(entry.value.data) &&
                       entry.value == ConfigValue{UnusableValue{"a table"}};
    if (table && text_[value] != '{')
      throw InputError(fmt::format("{}: edit {}: {} is a table, expected keys with values only",
                                   where, entry.item, entry.key));
    edits.back().keys.push_back({entry.key, at, value, offset_of(text_, entry.value_end)});
  }
  return edits;
}

const EditText::Edit& EditText::edit(std::size_t number) const {
  if (number > 0 && number <= edits_.size()) return edits_[number - 1];
  throw InputError(
      edits_.empty()
          ? fmt::format("{}: there is no edit {}, and no other", file_, number)
          : fmt::format("{}: there is no edit {}: expected 1 to {}; `voxweld edit {} --list` shows "
                        "them",
                        file_, number, edits_.size(), file_));
}

// As the first line is ended.
std::string EditText::line_break() const {
  const auto end = text_.find('\n');
  return end != std::string::npos && end > 0 && text_[end - 1] == '\r' ? "\r\n" : "\n";
}

void EditText::replace(std::size_t begin, std::size_t end, const std::string& by) {
  text_.replace(begin, end - begin, by);
  edits_ = locate();
}

// The lines from that of `first` to that of `last`. At the end of the text the line break before
// them goes in the place of theirs, which may be none.
void EditText::erase_lines(std::size_t first, std::size_t last) {
  const std::size_t begin = line_begin(text_, first);
  const std::size_t next = next_line(text_, last);
  if (next < text_.size() || begin == 0) return replace(begin, next, "");
  replace(line_end(text_, begin - 1), line_end(text_, last), "");
}

void EditText::add(const EditKeys& keys) {
  const auto before = said_beside(text_, 0);
  const std::string next = line_break();
  const std::size_t end = text_.ends_with('\n') ? line_end(text_, text_.size() - 1) : text_.size();
  std::string table = (text_.empty() ? "" : next + next) + fmt::format("[[{}]]", edit_table);
  for (const auto& [key, value] : keys) table += next + key_line(key, to_toml(value));
  replace(end, end, table);
  check_same(before, said_beside(text_, count()));
}

void EditText::change_one(std::size_t number, const std::string& key, const std::string& value) {
  const Edit& changed = edit(number);
  if (const Key* written = changed.find(key)) return replace(written->value, written->end, value);
  const std::size_t model = changed.keys.empty() ? changed.header : changed.keys.back().begin;
  const std::size_t begin = line_begin(text_, model);
  const std::string indent = text_.substr(begin, text_.find_first_not_of(" \t", begin) - begin);
  const std::size_t end = line_end(text_, changed.last());
  replace(end, end, line_break() + indent + key_line(key, value));
}

void EditText::change(std::size_t number, const EditKeys& keys) {
  edit(number);
  const auto before = said_beside(text_, number);
  for (const auto& [key, value] : keys) change_one(number, key, to_toml(value));
  check_same(before, said_beside(text_, number));
}

void EditText::drop(std::size_t number, std::span<const std::string> keys) {
  edit(number);
  const auto before = said_beside(text_, number);
  for (const std::string& key : keys)
    if (const Key* written = edit(number).find(key)) erase_lines(written->begin, written->end);
  check_same(before, said_beside(text_, number));
}

void EditText::remove(std::size_t number) {
  const Edit& removed = edit(number);
  const auto before = said_beside(text_, number);
  std::size_t begin = with_comment(text_, line_begin(text_, removed.header));
  const std::size_t next = next_line(text_, removed.last());
  // What stood apart still does.
  const bool apart = next == text_.size() || is_blank(text_, next);
  if (begin > 0 && apart && is_blank(text_, line_begin(text_, begin - 1)))
    begin = line_begin(text_, begin - 1);
  erase_lines(begin, removed.last());
  check_same(before, said_beside(text_, 0));
}

}  // namespace voxweld
