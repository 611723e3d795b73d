// Every key given wrong values in turn: the message names the place, the key, what is accepted and
// what was found.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

#include "pipeline/config/settings.h"
#include "tests/pipeline/config/config_texts.h"
#include "tests/pipeline/config/wrong_values.h"

namespace voxweld {
namespace {

using testing::error_of;
using testing::WrongKey;
using testing::WrongValue;

const std::vector<WrongKey> wrong_keys = testing::read_wrong_keys(R"table(
input.path: a path in quotes
  3; write paths in quotes | "" (a string)
  "a\tb" => "a\u0009b" (a string); it holds a control character; write backslashes twice
  ["a"] (a list of 1); write paths in quotes
input.format: "auto", "nrrd", "metaimage", "nifti", "inrimage", "vti", "vtk", "mrc", "amira", \
"raw", "zarr", "n5", "dicom", "hdf5", "vdb", "stack", "empty" or "mesh" (default: "auto")
  "NRRD" (a string); did you mean "nrrd"? | "bmp" (a string) | 1
input.crop: a list of 6 integers from 0 to 524287 (default: the whole volume)
  [0, 0, 0, 9, 9] (a list of 5) | [-1, 0, 0, 9, 9, 9] (a list of 6)
  [0, 0, 0, 9, 9, 9.5] (a list of 6) | 9
input.spacing: a finite number above 0, or three of them: [x, y, z] (default: as the file says, \
else 1)
  0 | [1, 2] (a list of 2) | [1, 2, 0] (a list of 3) | [1, 2, "3"] (a list of 3)
  1979-05-27 => a date
input.unit: "m", "cm", "mm", "um", "nm" or "angstrom" (default: as the file says)
  "MM" (a string); did you mean "mm"? | 1
input.size: a list of 3 integers from 1 to 524287 (default: none; raw files and empty space need \
it)
  [0, 1, 1] (a list of 3) | [1, 1, 1, 1] (a list of 4) | "1by1by1" (a string)
input.type: "uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32" \
or "float64" (default: none; raw files need it)
  "uint12" (a string); did you mean "uint16"? | 16
input.endian: "little" or "big" (default: "little")
  "litle" (a string); did you mean "little"? | true (a boolean)
input.header_bytes: an integer of at least 0 (default: 0)
  -1 | 1.0 | "8" (a string); write numbers without quotes
input.resolution: an integer from 4 to 524280 (default: none; meshes need it, or input.cell)
  3 | 524281 | 256.0
input.cell: a finite number above 0 (default: none; meshes need it, or input.resolution)
  0 | -0.1 | nan
input.margin: an integer from 1 to 65536 (default: 1)
  0 | 2.5
input.close: "no" or "winding" (default: "no")
  true (a boolean) | "wind" (a string)
work.directory: a path in quotes (default: "<config name>.work" beside the config)
  false (a boolean); write paths in quotes | "" (a string)
work.chunk: a power of two from 8 to 256 (default: 32)
  48; the nearest are 32 and 64 | 4 | 512 | -32 | 32.0
  "32" (a string); write numbers without quotes
work.brick: a power of two from 16 to 256 (default: 64)
  100; the nearest are 64 and 128 | 8 | 512
work.shard: a power of two from 1 to 16 (default: 4)
  0 | 3; the nearest are 2 and 4 | 32
work.copy: "auto", true or false (default: "auto")
  "always" (a string) | "false" (a string); write false without quotes | 0
surface.label: an integer of at least 0, in quotes above 9223372036854775807 (default: none: the \
surface is at the isovalue)
  -1 | 7.5 | "7-9" (a string) | "18446744073709551615" (a string); labels end at \
18446744073709551614
labels.mode: "off", "each" or "shared" (default: "off")
  "every" (a string) | true (a boolean)
labels.select: "all", "mapped" or a list of labels and ranges such as [1, 5, "10-20"] (default: \
"all")
  [] (a list of 0) | 5; write it in brackets: [5]
  "1-5" (a string); write it in brackets: ["1-5"] | "al" (a string); did you mean "all"?
  [1, -1] (a list of 2); found -1 in it | [1.5] (a list of 1); found 1.5 in it
  ["1-"] (a list of 1); found "1-" (a string) in it
  ["1 - 5"] (a list of 1); found "1 - 5" (a string) in it
  [[1, 5]] (a list of 1); found [1, 5] (a list of 2) in it
  ["20-10"] (a list of 1); the lower end comes first: "10-20"
  ["18446744073709551615"] (a list of 1); labels end at 18446744073709551614
  ["18446744073709551616"] (a list of 1); found "18446744073709551616" (a string) in it
  true (a boolean)
labels.background: a list of labels and ranges such as [1, 5, "10-20"] (default: [0])
  0; write it in brackets: [0] | "none" (a string)
labels.map: a path in quotes (default: none)
  ["a.csv"] (a list of 1); write paths in quotes | "" (a string)
labels.min_voxels: an integer of at least 0 (default: 0)
  -1
labels.max_voxels: an integer of at least 0 (default: 0)
  1.5
surface.isovalue: a finite number, "otsu" or "valley", or a list of such
  inf | nan | "Otsu" (a string); did you mean "otsu"?
  "120" (a string); write numbers without quotes | [] (a list of 0) | 07:32:00 => a time
  [5, 7, 5] (a list of 3); 5 is listed twice | ["otsu", "vally"] (a list of 2); did you mean "valley"?
surface.inside: "above" or "below" (default: "above")
  "over" (a string) | "Below" (a string); did you mean "below"? | 1
surface.border: "closed" or "open" (default: "closed")
  "close" (a string); did you mean "closed"? | true (a boolean)
surface.gradient: "auto", "subcell", "eno" or "central" (default: "auto")
  "centre" (a string); did you mean "central"? | 2
input.dataset: text in quotes, of one line (default: the only one there is)
input.series: text in quotes, of one line (default: the only one there is)
  5; write it in quotes | "" (a string)
input.level: an integer from 0 to 1000000 (default: the finest)
input.channel: an integer from 0 to 1000000 (default: the only one there is)
input.time: an integer from 0 to 1000000 (default: the only one there is)
  -1 | "0" (a string); write numbers without quotes | 1.5
input.resample: "none" or "uniform" (default: "none")
  "uniforn" (a string); did you mean "uniform"? | true (a boolean)
input.follow: true or false (default: false)
simplify.enabled: true or false (default: true)
output.tiles: true or false (default: true)
output.normals: true or false (default: true)
output.report: true or false (default: true)
  1 | "yes" (a string) | "true" (a string); write true without quotes | {} => a table
simplify.tolerance: a finite number above 0 (default: 0.1)
output.precision: a finite number above 0 (default: 0.01)
  0 | -0.5 | inf | nan | true (a boolean) | 9007199254740993
  "0.1" (a string); write numbers without quotes
simplify.tolerance_unit: "voxel" or "physical" (default: "voxel")
  "voxels" (a string); did you mean "voxel"? | 1
simplify.metric: "rms" or "sum" (default: "rms")
  "max" (a string) | 1
simplify.topology: "manifold", "safe" or "free" (default: "manifold")
  "save" (a string); did you mean "safe"? | true (a boolean)
simplify.qef: "qr" or "normal" (default: "qr")
  "normals" (a string); did you mean "normal"? | 1
simplify.refine: "auto", "off", "repair" or "collapse" (default: "auto")
  "collaps" (a string); did you mean "collapse"? | true (a boolean)
simplify.intersections: "none", "report" or "ignore" (default: "none")
  "no" (a string) | 0
simplify.triangles: an integer of at least 1 (default: none: tolerance decides)
  0 | -5 | 1.5
simplify.ratio: a number above 0, at most 1 (default: none: tolerance decides)
  0 | -0.5 | 1.5
output.directory: a path in quotes (default: "<config name>.mesh" beside the config)
  1.5; write paths in quotes | "" (a string)
output.formats: a list of one or more of "drc", "glb", "glb-plain", "meshopt", "ply", "stl", "obj" or "vtp", each once (default: ["drc", "glb"])
  [] (a list of 0) | "drc" (a string); write it in brackets: ["drc"]
  ["drc", "drc"] (a list of 2); drc is listed twice | ["drc", "gltf"] (a list of 2)
  [1] (a list of 1)
output.merged: "auto", true or false (default: "auto")
  "never" (a string) | 1
output.tile_vertices: "auto" or an integer from 1024 to 1000000000 (default: "auto")
output.levels: "auto" or an integer from 1 to 12 (default: 1)
  1023 | 5000000000 | 5e5 => 500000.0 | "many" (a string)
run.executor: "local" or "slurm" (default: "local")
  "locl" (a string); did you mean "local"? | "SLURM" (a string); did you mean "slurm"? | 1
run.threads: an integer from 0 to 4096 (default: 0)
  -1 | 4097 | "all" (a string)
run.memory: text such as "4GiB" or a number of bytes, at least 64MiB (default: "4GiB")
  "4G" (a string); units are B, KiB, MiB, GiB, TiB, KB, MB, GB and TB | "63MiB" (a string) | 1000
  -1 | 4.5
slurm.partition: a name in quotes, without spaces, quotes, \ and # (default: "")
slurm.account: a name in quotes, without spaces, quotes, \ and # (default: "")
slurm.qos: a name in quotes, without spaces, quotes, \ and # (default: "")
  3; write names in quotes | ["a"] (a list of 1); write names in quotes | "a b" (a string)
  "a#b" (a string) | "a'" (a string) | "a\nb" => "a\u000ab" (a string)
slurm.time: a time in quotes: "minutes", "m:s", "h:m:s", "days-h", "days-h:m" or "days-h:m:s" \
(default: "4:00:00")
  90; write it in quotes | 04:00:00 => a time; write it in quotes | "" (a string)
  "4h" (a string) | "1:2:3:4" (a string) | "1-2-3" (a string) | "1:2-3" (a string)
  "-3" (a string) | "1-" (a string) | "1234567890" (a string)
slurm.cpus_per_task: an integer from 1 to 1024 (default: 4)
  0 | 1025 | "4" (a string); write numbers without quotes
slurm.mem: "auto", text such as "4GiB" or a number of bytes, at least 64MiB (default: "auto")
  "8G" (a string); units are B, KiB, MiB, GiB, TiB, KB, MB, GB and TB | 0 | "63MiB" (a string)
slurm.max_array: an integer from 1 to 1000000 (default: 1000)
  0
slurm.max_running: an integer from 0 to 1000000 (default: 0)
  -1
slurm.shards_per_task: "auto" or an integer of at least 1 (default: "auto")
  0 | "all" (a string) | 1.0
slurm.retries: an integer from 0 to 100 (default: 3)
  -1 | 101
slurm.extra: a list of options, each text of one line beginning with - (default: [])
  "--exclusive" (a string); write it in brackets | ["exclusive"] (a list of 1)
  ["-"] (a list of 1) | [1] (a list of 1)
  ["--array=1-3"] (a list of 1); --array is set by voxweld itself
  ["-ofile"] (a list of 1); -o is set by voxweld itself
  ["--depend=afterok:1"] (a list of 1); --dependency is set by voxweld itself
slurm.prologue: a list of texts of one line each (default: [])
  "module load gcc" (a string); write it in brackets | ["a\nb"] => ["a\u000ab"] (a list of 1)
  [true] (a list of 1)
)table");

TEST(ValueError, CoversEveryKey) {
  std::set<std::string> covered;
  for (const WrongKey& key : wrong_keys) covered.insert(key.name);
  for (const Setting& setting : settings()) EXPECT_TRUE(covered.contains(setting.name()));
  EXPECT_EQ(covered.size(), settings().size());
}

TEST(ValueError, NamesPlaceKeyExpectedAndFound) {
  for (const WrongKey& key : wrong_keys) {
    for (const WrongValue& wrong : key.values) {
      const std::string text = fmt::format("# first line\n{} = {}\n", key.name, wrong.value);
      EXPECT_EQ(error_of(text),
                fmt::format("/data/scan.toml:2:{}: {}: expected {}, found {}", key.name.size() + 4,
                            key.name, key.expected, wrong.found));
    }
  }
}

TEST(ValueError, NamesTheOverride) {
  for (const WrongKey& key : wrong_keys) {
    // On the command line any text is a path or a name.
    const bool any_text = key.expected.find("in quotes") != std::string::npos;
    for (const WrongValue& wrong : key.values) {
      if (any_text && wrong.value[0] != '"') continue;
      const std::string option = key.name + "=" + wrong.value;
      const std::string message = error_of(testing::least_config(), {option});
      EXPECT_TRUE(message.starts_with("--set " + key.name + "=")) << message;
      EXPECT_TRUE(message.ends_with(
          fmt::format(": {}: expected {}, found {}", key.name, key.expected, wrong.found)))
          << message;
    }
  }
}

TEST(ValueError, LongValuesAreCut) {
  const std::string message = error_of("surface.inside = \"" + std::string(5000, 'a') + "\"\n");
  EXPECT_LT(message.size(), 200U);
  std::string list = "[1";
  for (int i = 0; i < 5000; ++i) list += ", 1";
  EXPECT_LT(error_of("input.crop = " + list + "]\n").size(), 250U);
}

}  // namespace
}  // namespace voxweld
