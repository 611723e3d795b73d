// What the labels of a volume are, as a document: from counts that come one by one.
#pragma once

#include <vector>

#include "pipeline/info/facts.h"
#include "storage/artifact/label_counts.h"

namespace voxweld {

// Of samples that pass: counts their labels in bounded memory. Beyond 2^18 labels a scratch file in
// the system's temporary folder is used. InputError unless `source` holds integers.
InfoDocument label_facts(const SampleSource& source, const ScanHooks& hooks);
// The same while the samples are scanned for their values.
InfoDocument label_facts(const SampleSource& source, const ScanHooks& hooks, ScanResult& scan);
// Of counts that are there.
InfoDocument label_facts(const LabelCounts& counts);

}  // namespace voxweld
