#include "pipeline/ingest/isovalue_choice.h"

#include <fmt/format.h>

#include <optional>
#include <string>

#include "pipeline/ingest/filtered_input.h"
#include "storage/support/error.h"

namespace voxweld {

IsovalueSuggestion choose_isovalue(const Config& config, const IngestJob& job) {
  const IngestJob& seen = histogram_job(job);
  const std::optional<Histogram> counted = read_histogram(seen);
  if (!counted)
    throw InputError(fmt::format(
        "surface.isovalue = \"{}\" needs the histogram that stage ingest makes of {}, and "
        "that is missing or out of date; run `voxweld ingest CONFIG` first, or `voxweld "
        "run CONFIG` for all",
        isovalue_rule_name(config.surface.isovalue_rule), config.input.path.string()));
  const Histogram& histogram = *counted;
  const ValueScale& scale = seen.info.scale;
  const IsovalueRule rule = config.surface.isovalue_rule;
  if (const auto suggestion = suggest_isovalue(histogram, scale, rule)) return *suggestion;
  const std::string path = config.input.path.string();
  if (rule == IsovalueRule::valley && suggest_isovalue(histogram, scale))
    throw InputError(fmt::format(
        "surface.isovalue = \"valley\": the histogram of {} has one peak, so no valley; see "
        "`voxweld histogram`, give a number or \"otsu\"",
        path));
  throw InputError(
      fmt::format("surface.isovalue = \"{}\": all samples of {} {}, so there is no threshold to "
                  "find; give a number",
                  isovalue_rule_name(rule), path, no_threshold_text(histogram, scale)));
}

}  // namespace voxweld
