// Based on: NEMA, "Digital Imaging and Communications in Medicine", PS3.5 (2023), chapters 7, A.
// Values other than those that matter are passed over unread, so that no length in a file makes
// anybody allocate.
#include "storage/dicom/data_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string_view>

#include "storage/dicom/element_values.h"
#include "storage/support/byte_order.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::uint32_t undefined_length = 0xffffffff;
constexpr DicomTag item_tag = 0xfffee000, item_end = 0xfffee00d, sequence_end = 0xfffee0dd;
constexpr int deepest = 24;
constexpr std::size_t longest_value = std::size_t{1} << 20;
constexpr std::size_t most_items = std::size_t{1} << 20;

constexpr std::string_view all_vrs =
    "AE AS AT CS DA DS DT FD FL IS LO LT OB OD OF OL OV OW PN SH SL SQ SS ST SV TM UC UI UL UN UR "
    "US UT UV ";
constexpr std::string_view long_vrs = "OB OD OF OL OV OW SQ SV UC UN UR UT UV ";

bool one_of(std::string_view vrs, std::string_view vr) {
  for (std::size_t at = 0; at < vrs.size(); at += 3)
    if (vrs.substr(at, 2) == vr) return true;
  return false;
}

struct ElementHead {
  std::uint64_t at = 0;  // where it begins
  DicomTag tag = 0;
  std::string vr;  // empty where the file does not say
  std::uint32_t length = 0;
};

class HeaderReader {
 public:
  explicit HeaderReader(DicomBytes& bytes) : bytes_(bytes), cursor_(bytes) {}

  DicomHeader read();

 private:
  // Where elements stand: up to where, and whether an end of item ends them before that.
  struct Place {
    std::uint64_t end = 0;
    bool delimited = false;
    bool top = false;
    int depth = 0;
  };

  [[noreturn]] void fail(std::uint64_t at, const std::string& what) const {
    throw FormatError(
        fmt::format("{}: offset {}: {}: the file is damaged or no DICOM: copy it again",
                    bytes_.path(), at, what));
  }
  ElementHead head(std::uint64_t end);
  // `out` is null where nothing of it is kept.
  void read_elements(const Place& place, DataSet* out);
  bool at_end(const Place& place, const ElementHead& found) const;
  void read_value(const ElementHead& found, const Place& place, DataSet* out);
  void read_items(const ElementHead& found, const Place& place, DicomElement* out);
  void skip(const ElementHead& found, std::uint64_t end);
  bool note_pixels(const ElementHead& found);
  void read_meta();
  void settle_syntax();

  DicomBytes& bytes_;
  DicomCursor cursor_;
  bool explicit_ = true;
  std::size_t items_ = 0;
  std::string uid_;
  DicomHeader header_;
};

ElementHead HeaderReader::head(std::uint64_t end) {
  ElementHead found;
  found.at = cursor_.at;
  if (end - cursor_.at < 8) fail(cursor_.at, "breaks off within a data element");
  const std::uint32_t group = cursor_.u16();
  found.tag = (group << 16) | cursor_.u16();
  if (group == 0xfffe || !explicit_) {
    found.length = cursor_.u32();
    return found;
  }
  found.vr = cursor_.text(2);
  if (!one_of(all_vrs, found.vr))
    fail(found.at,
         fmt::format("{} has a value representation that does not exist", tag_text(found.tag)));
  if (!one_of(long_vrs, found.vr)) {
    found.length = cursor_.u16();
    return found;
  }
  if (end - cursor_.at < 6) fail(found.at, "breaks off within a data element");
  cursor_.at += 2;
  found.length = cursor_.u32();
  return found;
}

void HeaderReader::skip(const ElementHead& found, std::uint64_t end) {
  if (found.length > end - cursor_.at)
    fail(found.at, fmt::format("{} is {} bytes long, but {} are left", tag_text(found.tag),
                               found.length, end - cursor_.at));
  cursor_.at += found.length;
}

bool HeaderReader::at_end(const Place& place, const ElementHead& found) const {
  if (place.delimited && found.tag == item_end) return true;
  if (found.tag >> 16 == 0xfffe)
    fail(found.at, fmt::format("{} stands where it has no meaning", tag_text(found.tag)));
  return false;
}

void HeaderReader::read_elements(const Place& place, DataSet* out) {
  if (place.depth > deepest) fail(cursor_.at, "sequences are nested too deeply");
  if (out != nullptr) out->order = cursor_.order;
  while (cursor_.at < place.end) {
    const ElementHead found = head(place.end);
    if (at_end(place, found)) return;
    if (place.top && found.tag >= dicom::float_pixels && note_pixels(found)) return;
    read_value(found, place, out);
  }
  if (place.delimited) fail(cursor_.at, "an item of a sequence has no end");
}

void HeaderReader::read_value(const ElementHead& found, const Place& place, DataSet* out) {
  const bool kept = out != nullptr && is_kept(found.tag) && out->find(found.tag) == nullptr;
  const bool sequence = found.vr == "SQ" || found.length == undefined_length ||
                        (found.vr.empty() && is_kept_sequence(found.tag));
  if (sequence) {
    DicomElement element;
    element.tag = found.tag;
    read_items(found, place, kept ? &element : nullptr);
    if (kept) out->elements.push_back(std::move(element));
    return;
  }
  if (found.length > place.end - cursor_.at || !kept || found.length > longest_value)
    return skip(found, place.end);
  out->elements.push_back({found.tag, cursor_.text(found.length), {}});
}

void HeaderReader::read_items(const ElementHead& found, const Place& place, DicomElement* out) {
  const bool open = found.length == undefined_length;
  if (!open && found.length > place.end - cursor_.at) skip(found, place.end);  // says so
  const std::uint64_t end = open ? place.end : cursor_.at + found.length;
  // What is unknown and of no stated length is implicit inside (PS3.5, 6.2.2).
  const bool was_explicit = explicit_;
  if (found.vr == "UN" && open) explicit_ = false;
  while (cursor_.at < end || open) {
    const ElementHead item = head(end);
    if (open && item.tag == sequence_end) break;
    if (item.tag != item_tag)
      fail(item.at, fmt::format("expected an item of {}, found {}", tag_text(found.tag),
                                tag_text(item.tag)));
    if (++items_ > most_items) fail(item.at, "has more than 2^20 items of sequences");
    const bool delimited = item.length == undefined_length;
    if (!delimited && (out == nullptr || item.length > end - cursor_.at)) {
      skip(item, end);
      continue;
    }
    if (out != nullptr) out->items.emplace_back();
    read_elements({delimited ? end : cursor_.at + item.length, delimited, false, place.depth + 1},
                  out != nullptr ? &out->items.back() : nullptr);
  }
  explicit_ = was_explicit;
}

// Whether the samples begin here.
bool HeaderReader::note_pixels(const ElementHead& found) {
  if (found.tag > dicom::pixels) return true;  // what follows them, without any
  PixelPlace& place = header_.place;
  place = {found.tag, found.vr, cursor_.at, found.length, found.length == undefined_length};
  if (place.fragments) place.length = bytes_.size() - cursor_.at;
  return true;
}

void HeaderReader::read_meta() {
  std::array<std::byte, 132> start{};
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(132, bytes_.size()));
  bytes_.read(0, std::span(start).first(count));
  const bool preamble = count == 132 && std::memcmp(start.data() + 128, "DICM", 4) == 0;
  cursor_.at = preamble ? 132 : 0;
  while (bytes_.size() - cursor_.at >= 8) {
    const std::uint64_t at = cursor_.at;
    const bool meta = cursor_.u16() == 2;
    cursor_.at = at;
    if (!meta) break;
    const ElementHead found = head(bytes_.size());
    if (found.tag == dicom::syntax_uid && found.length <= 64 &&
        found.length <= bytes_.size() - cursor_.at)
      uid_ = trimmed_value(cursor_.text(found.length));
    else
      skip(found, bytes_.size());
  }
}

void HeaderReader::settle_syntax() {
  if (uid_.empty()) uid_ = implicit_little_uid;
  header_.syntax = transfer_syntax(uid_);
  if (header_.syntax.deflated) {
    bytes_.inflate(cursor_.at);
    cursor_.forget();
  }
  if (bytes_.size() - cursor_.at < 8) fail(cursor_.at, "has no data elements");
  // Some writers say the one and write the other.
  if (header_.syntax.order == std::endian::little) {
    const std::uint64_t at = cursor_.at;
    cursor_.at += 4;
    const bool says_vr = one_of(all_vrs, cursor_.text(2));
    cursor_.at = at;
    if (says_vr != header_.syntax.explicit_vr) {
      header_.note = fmt::format("its transfer syntax is {} ({}), but its elements {} their type",
                                 uid_, header_.syntax.name, says_vr ? "state" : "do not state");
      header_.syntax.explicit_vr = says_vr;
    }
  }
  explicit_ = header_.syntax.explicit_vr;
  cursor_.order = header_.syntax.order;
}

DicomHeader HeaderReader::read() {
  read_meta();
  settle_syntax();
  read_elements({bytes_.size(), false, true, 0}, &header_.data);
  return std::move(header_);
}

}  // namespace

DicomHeader read_dicom_header(DicomBytes& bytes) {
  return HeaderReader(bytes).read();
}

}  // namespace voxweld
