// What is read, and which surface of it.
#include "pipeline/config/setting_rows.h"

namespace voxweld::rows {

std::vector<Setting> input_settings() {
  using In = InputConfig;
  constexpr auto in = &Config::input;
  return {
      // What the file holds is in the keys by content, so moving it re-runs nothing.
      required(
          row({"input", "path",
               "The volume: a file, a directory of slices or a Zarr array; or a closed triangle "
               "mesh in an .stl, .off, .obj or .ply file. What it holds decides what is done "
               "again, not its name."},
              binding::member(in, &In::path, PathRule{}), none)),
      row({"input", "format",
           "How to read it. \"auto\" goes by the content and the name. \"empty\" is no file but "
           "empty space of input.size, for what [[edit]] makes in it: it needs no path and no "
           "isovalue. \"mesh\" needs no isovalue either, but a resolution or cell."},
          binding::input_format(), ingest),
      row({"input", "crop", "The box of samples to use, half-open: [x0, y0, z0, x1, y1, z1].",
           "the whole volume"},
          binding::member(in, &In::crop, IntegerListRule{6, 0, most_samples}), ingest_and_build),
      row({"input", "spacing",
           "Distance of neighbouring samples: one number or [x, y, z]. Overrides the file's.",
           "as the file says, else 1"},
          binding::member(in, &In::spacing, SpacingRule{}), lengths),
      row({"input", "unit", "Unit of the spacing. Overrides the file's.", "as the file says"},
          binding::unit(), encode),
      when_given(
          row({"input", "dataset",
               "Which array or grid, where a file holds several: its path or name in the file. "
               "`voxweld info` lists them, and what the next four can be.",
               "the only one there is"},
              binding::selected(&InputSelection::dataset), ingest_and_build)),
      when_given(row({"input", "series",
                      "DICOM: which series, where a folder holds several: its UID, or its number.",
                      "the only one there is"},
                     binding::selected(&InputSelection::series), ingest_and_build)),
      when_given(
          row({"input", "level", "Which resolution of a pyramid. 0 is the finest.", "the finest"},
              binding::selected(&InputSelection::level), ingest_and_build)),
      when_given(
          row({"input", "channel", "Which channel, counted from 0.", "the only one there is"},
              binding::selected(&InputSelection::channel), ingest_and_build)),
      when_given(
          row({"input", "time", "Which point in time, counted from 0.", "the only one there is"},
              binding::selected(&InputSelection::time), ingest_and_build)),
      when_given(
          row({"input", "resample",
               "DICOM: what to do where slices are not equally far apart. \"none\" refuses them; "
               "\"uniform\" interpolates slices at equal distances.",
               "\"none\""},
              binding::choice_or_open(in, &In::resample, {"none", "uniform"}), ingest_and_build)),
      row({"input", "size",
           "Raw files and empty space: samples along [x, y, z], x fastest in the file.",
           "none; raw files and empty space need it"},
          binding::member(in, &In::size, IntegerListRule{3, 1, most_samples}), ingest_and_build),
      row({"input", "type", "Raw only: type of a sample.", "none; raw files need it"},
          binding::raw_type(), ingest_and_build),
      row({"input", "endian", "Raw only: byte order of a sample."},
          binding::choice(in, &In::endian, {"little", "big"}), ingest_and_build),
      row({"input", "header_bytes", "Raw only: bytes before the first sample."},
          binding::member(in, &In::header_bytes, IntegerRule{0, no_limit}), ingest_and_build),
      row({"input", "follow",
           "NRRD and MetaImage: lets a header name data files by absolute paths, or outside its "
           "own "
           "folder."},
          binding::member(in, &In::follow, FlagRule{}), none),
      row({"input", "resolution",
           "Meshes only: cells along the longest side of the mesh's bounding box, the margin not "
           "counted.",
           "none; meshes need it, or input.cell"},
          binding::member(in, &In::resolution, IntegerRule{least_resolution, most_resolution}),
          lengths),
      row({"input", "cell", "Meshes only: the side of a cell, in the mesh's own unit.",
           "none; meshes need it, or input.resolution"},
          binding::member(in, &In::cell, PositiveNumberRule{}), lengths),
      row({"input", "margin",
           "Meshes only: cells of empty space around the mesh's bounds, and half a cell more. "
           "Solids that [[edit]] adds need room there."},
          binding::member(in, &In::margin, IntegerRule{1, 65536}), lengths),
      row({"input", "close",
           "Meshes only: \"no\" refuses one that is not closed; \"winding\" closes its holes, and "
           "makes one of what overlaps: inside is where its triangles wind around at least half "
           "(generalized winding number)."},
          binding::choice(in, &In::close, {"no", "winding"}), build),
  };
}

std::vector<Setting> work_settings() {
  using Work = WorkConfig;
  constexpr auto work = &Config::work;
  return {
      row({"work", "directory",
           "Where intermediate files and finished work are kept, to resume from.",
           "\"<config name>.work\" beside the config"},
          binding::member(work, &Work::directory, PathRule{}), none),
      row({"work", "chunk",
           "Samples a side of the brick store's chunks. At most brick * shard. Never changes the "
           "result."},
          binding::member(work, &Work::chunk, PowerOfTwoRule{8, 256}), ingest),
      row({"work", "brick",
           "Cells a side of a brick: one octree. Unless it is given, 32 where run.memory is below "
           "1GiB, 16 below 256MiB. Never changes the result."},
          binding::member(work, &Work::brick, PowerOfTwoRule{16, 256}), ingest_and_build),
      row({"work", "shard",
           "Bricks a side of a shard, one store file and build task. Never changes the result. "
           "From a volume that is not copied first, whole rows are read for each shard: with 2048 "
           "samples a side or more, 8 or 16 are quicker."},
          binding::member(work, &Work::shard, PowerOfTwoRule{1, 16}), ingest_and_build),
      row({"work", "copy",
           "Copy the samples into the brick store first. \"auto\" copies only inputs that cannot "
           "be read in boxes."},
          binding::switch_of(work, &Work::copy), none),
  };
}

std::vector<Setting> surface_settings() {
  using Surface = SurfaceConfig;
  constexpr auto surface = &Config::surface;
  return {
      required(
          row({"surface", "isovalue",
               "The value the surface runs through. \"otsu\" and \"valley\" choose it from the "
               "histogram: \"otsu\" so that it parts the samples into two classes best, "
               "\"valley\" in the deepest valley between the two clearest peaks, also where "
               "one of them is small (`voxweld histogram` shows both). A list makes a set of "
               "meshes for "
               "each of its values, in folders of output.directory. "
               "Where the file has a slope and an intercept it is a real value, such as HU, "
               "not a stored number. Integers above 9223372036854775807 are written in "
               "quotes."},
              binding::isovalue(), build)),
      row({"surface", "label",
           "Of a label volume: the label whose surface to extract, in place of an isovalue. Inside "
           "are the samples of this value; crossings and normals come from a filter over five "
           "samples a side, so that they are smooth.",
           "none: the surface is at the isovalue"},
          binding::surface_label(), build),
      row({"surface", "inside", "Which side of the isovalue is material. Equal is inside."},
          binding::choice(surface, &Surface::inside, {"above", "below"}), build),
      row({"surface", "border",
           "\"closed\" caps material that reaches the volume's border; \"open\" leaves it open."},
          binding::choice(surface, &Surface::border, {"closed", "open"}), border),
      row({"surface", "gradient",
           "How crossings and normals are estimated: \"central\" blurs noise and creases, \"eno\" "
           "keeps normals apart at creases, \"subcell\" places crossings there too. \"auto\" does "
           "so where creases are clearer than the samples' noise, which it measures."},
          binding::choice(surface, &Surface::gradient, {"auto", "subcell", "eno", "central"}),
          build),
  };
}

std::vector<Setting> labels_settings() {
  using Labels = LabelsConfig;
  constexpr auto labels = &Config::labels;
  return {
      row({"labels", "mode",
           "Take the samples for labels instead of comparing them with an isovalue. \"each\": one "
           "closed mesh for every label; \"shared\": one non-manifold mesh of them all, in "
           "which neighbours share triangles."},
          binding::choice(labels, &Labels::mode, {"off", "each", "shared"}), build),
      by_effect(row({"labels", "select",
                     "The labels to mesh: \"all\", \"mapped\" (those that labels.map names) or a "
                     "list. They are sample values, before labels.map merges any; those above "
                     "9223372036854775807 are written in quotes."},
                    binding::selected_labels(), build)),
      by_effect(row(
          {"labels", "background", "Labels that are left out, unless labels.select lists them."},
          binding::background(), build)),
      by_effect(
          row({"labels", "map",
               "A file that merges labels, leaves some out, and gives names and colours: CSV, "
               "JSON, a colour table of 3D Slicer or label descriptions of ITK-SNAP. The columns "
               "of a CSV are label (needed), material (what the label becomes part of; -1 leaves "
               "it out), name, and color or r, g and b. Labels it does not name are kept. What it "
               "holds decides what is done again, not its name.",
               "none"},
              binding::member(labels, &Labels::map, PathRule{}), build)),
      by_effect(row(
          {"labels", "min_voxels", "Leave out what has fewer samples, after labels were merged."},
          binding::member(labels, &Labels::min_voxels, IntegerRule{0, no_limit}), build)),
      by_effect(row({"labels", "max_voxels",
                     "Leave out what has more samples, after labels were merged; 0: no limit."},
                    binding::member(labels, &Labels::max_voxels, IntegerRule{0, no_limit}), build)),
  };
}

}  // namespace voxweld::rows
