// Changes to the [[edit]] tables of a config file as text. What is not of the table concerned stays
// byte for byte: comments, order, white space, ends of lines, and how the file ends.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/config/config_value.h"

namespace voxweld {

using EditKeys = std::vector<std::pair<std::string, ConfigValue>>;

class EditText {
 public:
  // `file` names the text in messages. Throws InputError where it is not TOML or its edits are not
  // tables [[edit]] of plain keys; whether their keys and values are right is not looked at.
  EditText(std::string text, std::string file);

  const std::string& text() const { return text_; }
  std::size_t count() const { return edits_.size(); }

  // Puts a table behind all else, after an empty line.
  void add(const EditKeys& keys);
  // Gives keys other values where they are written, or below the table's last. `number` from 1.
  // InputError where there is no such edit, here and below.
  void change(std::size_t number, const EditKeys& keys);
  // Removes those of the keys that are written, each with the rest of its lines.
  void drop(std::size_t number, std::span<const std::string> keys);
  // Removes the lines from the header to the last key. With them go the comment that stands
  // directly above the header, where an empty line sets it apart from what is before, and one of
  // the empty lines above. Undoes add().
  void remove(std::size_t number);

 private:
  struct Key {
    std::string name;
    std::size_t begin, value, end;  // bytes: of its name, of its value, behind its value
  };
  struct Edit {
    std::size_t header;  // byte of its [[
    std::vector<Key> keys;
    // In its last line.
    std::size_t last() const;
    const Key* find(const std::string& name) const;
  };

  std::vector<Edit> locate() const;
  const Edit& edit(std::size_t number) const;
  void change_one(std::size_t number, const std::string& key, const std::string& value);
  void replace(std::size_t begin, std::size_t end, const std::string& by);
  void erase_lines(std::size_t first, std::size_t last);
  std::string line_break() const;

  std::string text_, file_;
  std::vector<Edit> edits_;
};

}  // namespace voxweld
