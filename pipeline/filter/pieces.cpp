#include "pipeline/filter/pieces.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "pipeline/filter/piece_pass.h"
#include "pipeline/stage/units_here.h"
#include "storage/artifact/piece_changes.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// 1234567 as "1,234,567".
std::string grouped(std::uint64_t number) {
  std::string digits = std::to_string(number);
  for (std::size_t behind = 3; behind < digits.size(); behind += 4)
    digits.insert(digits.size() - behind, 1, ',');
  return digits;
}

// Whether the filter turns samples inside out, and not the other way.
bool takes_away(const PieceRule& rule) {
  return rule.what == PieceRule::What::keep;
}

std::string side_text(const PieceRule& rule) {
  return takes_away(rule) ? "outside" : "inside";
}

std::optional<StoredBits> value_given(const PieceRule& rule, SampleType type) {
  if (!rule.value) return {};
  const auto bits = nearest_stored(type, *rule.value);
  if (!bits)
    throw InputError(fmt::format("{}: the value {} is none that samples of {} can have",
                                 filter_name(rule), *rule.value, sample_type_name(type)));
  if (is_inside(type, *bits, rule.isovalue, rule.inside) == takes_away(rule))
    throw InputError(fmt::format(
        "{}: samples become {}, which must lie {} the surface: it is {} (isovalue {}, inside {}); "
        "give another value, or none",
        filter_name(rule), stored_text(type, *bits), side_text(rule),
        takes_away(rule) ? "inside" : "outside", isovalue_text(rule.isovalue),
        rule.inside == Inside::above ? "above" : "below"));
  return bits;
}

// Where nothing changes any will do.
StoredBits value_found(const PieceRule& rule, SampleType type, const FoundPieces& found) {
  if (found.tally.changed_samples == 0) return 0;
  const bool least = takes_away(rule) == (rule.inside == Inside::above);
  const StoredBits bits = least ? found.range.least : found.range.greatest;
  if (found.range.empty || is_inside(type, bits, rule.isovalue, rule.inside) == takes_away(rule))
    throw InputError(fmt::format(
        "{}: no sample of the volume lies {} the surface (isovalue {}), so there is none that the "
        "changed ones could become: give a value",
        filter_name(rule), side_text(rule), isovalue_text(rule.isovalue)));
  return bits;
}

void tell_of(const PieceRule& rule, const PieceChangesSummary& s) {
  const auto type = static_cast<SampleType>(s.type);
  const std::string becomes =
      s.changed_samples == 0
          ? "nothing changes"
          : fmt::format("{} of their {} samples become {}", grouped(s.changed_samples),
                        grouped(s.samples), stored_text(type, s.value));
  const bool keep = takes_away(rule);
  spdlog::info("{}: {} of {} {} {}, {}", filter_name(rule),
               grouped(keep ? s.pieces - s.changed_pieces : s.changed_pieces), grouped(s.pieces),
               keep ? "pieces" : "holes", keep ? "kept" : "filled", becomes);
}

}  // namespace

void find_pieces_in_blocks(RunContext& context, const SampleSource& source, const PieceRule& rule,
                           const std::filesystem::path& path, Hash128 key, std::int64_t side) {
  const VolumeInfo& info = source.info();
  const auto given = value_given(rule, info.type);
  const UnitsHere here(context);
  PieceLedger ledger(path.parent_path());
  const FoundPieces found = pass_over_pieces(context, source, rule, side, ledger);
  PieceChangesWriter out(path, key);
  ledger.write(found.spared, out, context.interrupt);
  const PieceChangesSummary summary{info.geometry.size,
                                    side,
                                    static_cast<std::uint64_t>(info.type),
                                    given ? *given : value_found(rule, info.type, found),
                                    rule.isovalue.value,
                                    rule.isovalue.rest,
                                    rule.inside == Inside::below ? 1U : 0U,
                                    side_of(rule).within ? 0U : 1U,
                                    found.tally.pieces,
                                    found.tally.changed_pieces,
                                    found.tally.samples,
                                    found.tally.changed_samples};
  out.commit(summary);
  tell_of(rule, summary);
}

void find_pieces(RunContext& context, const SampleSource& source, const PieceRule& rule,
                 const std::filesystem::path& path, Hash128 key) {
  if (!pieces_are_found(path, key))
    find_pieces_in_blocks(context, source, rule, path, key, most_block_side);
}

bool pieces_are_found(const std::filesystem::path& path, Hash128 key) {
  if (!file_state(path)) return false;
  try {
    return PieceChanges(path).key() == key;
  } catch (const DamagedArtifact&) {
    return false;
  }
}

}  // namespace voxweld
