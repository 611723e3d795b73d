#include "storage/artifact/piece_changes.h"

#include <algorithm>
#include <bit>

#include "storage/types/sample_type.h"

namespace voxweld {
namespace {

constexpr std::uint64_t pieces_summary_section = 1, first_page_section = 2;
constexpr std::size_t most_page_blocks = 4096, most_page_words = 8192;
constexpr std::uint64_t every_piece = 0xffffffff;  // in place of where the bits begin

bool all_set(std::uint32_t pieces, std::span<const std::uint64_t> bits) {
  std::uint64_t set = 0;
  for (const std::uint64_t word : bits) set += static_cast<std::uint64_t>(std::popcount(word));
  return set == pieces;
}

bool sound(const PieceChangesSummary& summary) {
  return !Box3{{}, summary.size}.empty() && summary.side >= 1 && summary.side <= 64 &&
         summary.type <= static_cast<std::uint64_t>(SampleType::f64) &&
         summary.changed_pieces <= summary.pieces && summary.changed_samples <= summary.samples;
}

}  // namespace

PieceChangesWriter::PieceChangesWriter(const std::filesystem::path& path, Hash128 key)
    : file_(path, {piece_changes_kind, piece_changes_version, key}) {}

void PieceChangesWriter::add(std::uint64_t block, std::uint32_t pieces,
                             std::span<const std::uint64_t> bits) {
  if (std::all_of(bits.begin(), bits.end(), [](std::uint64_t word) { return word == 0; })) return;
  if (!records_.empty() && block < records_[records_.size() - 2]) flush();
  const bool all = all_set(pieces, bits);
  records_.push_back(block);
  records_.push_back(pieces | (all ? every_piece : words_.size()) << 32);
  if (!all) words_.insert(words_.end(), bits.begin(), bits.end());
  if (records_.size() >= 2 * most_page_blocks || words_.size() >= most_page_words) flush();
}

void PieceChangesWriter::flush() {
  if (records_.empty()) return;
  const std::uint64_t count = records_.size() / 2;
  file_.begin_section(first_page_section + records_[0]);
  file_.append(as_record(count));
  file_.append(as_section(records_));
  file_.append(as_section(words_));
  file_.end_section();
  records_.clear();
  words_.clear();
}

void PieceChangesWriter::commit(const PieceChangesSummary& summary) {
  flush();
  file_.section(pieces_summary_section, as_record(summary));
  file_.commit();
}

PieceChanges::PieceChanges(const std::filesystem::path& path)
    : OpenArtifact(path, piece_changes_kind, piece_changes_version),
      summary_(file_.read_record<PieceChangesSummary>(pieces_summary_section,
                                                      "its summary has an odd size")) {
  if (!sound(summary_)) file_.damaged("its summary contradicts itself");
}

std::vector<std::uint64_t> PieceChanges::read_page(std::uint64_t name) const {
  std::vector<std::uint64_t> page;
  file_.read_array(name, page);
  const auto refuse = [&] { file_.damaged("a page of its blocks contradicts itself"); };
  if (page.empty() || page[0] == 0 || page[0] > (page.size() - 1) / 2) refuse();
  if (page[1] != name - first_page_section) refuse();
  const std::uint64_t words = page.size() - 1 - 2 * page[0];
  for (std::uint64_t i = 0; i < page[0]; ++i) {
    const std::uint64_t block = page[1 + 2 * i], record = page[2 + 2 * i];
    if (i > 0 && block <= page[2 * i - 1]) refuse();
    const auto pieces = static_cast<std::uint32_t>(record);
    if (pieces == 0) refuse();
    if (record >> 32 != every_piece && (record >> 32) + piece_words(pieces) > words) refuse();
  }
  return page;
}

std::optional<PieceChanges::Block> PieceChanges::find(std::uint64_t block) const {
  const auto sections = file_.sections();
  const auto behind = std::upper_bound(
      sections.begin(), sections.end(), first_page_section + block,
      [](std::uint64_t name, const SectionRecord& section) { return name < section.name; });
  if (behind == sections.begin() || (behind - 1)->name < first_page_section) return {};
  const std::uint64_t name = (behind - 1)->name;
  const auto page = pages_.get(
      name, [&] { return std::make_shared<const std::vector<std::uint64_t>>(read_page(name)); });
  std::uint64_t lo = 0, hi = (*page)[0];  // the first block that is not before it
  while (lo < hi) {
    const std::uint64_t middle = lo + (hi - lo) / 2;
    if ((*page)[1 + 2 * middle] < block)
      lo = middle + 1;
    else
      hi = middle;
  }
  if (lo == (*page)[0] || (*page)[1 + 2 * lo] != block) return {};
  const std::uint64_t record = (*page)[2 + 2 * lo];
  Block found{static_cast<std::uint32_t>(record), record >> 32 == every_piece, {}, page};
  if (!found.all)
    found.bits =
        std::span(*page).subspan(1 + 2 * (*page)[0] + (record >> 32), piece_words(found.pieces));
  return found;
}

}  // namespace voxweld
