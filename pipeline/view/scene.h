// What there is to show, as the page asks for it at /api/scene.
//
// JSON, one object; keys that a scene has no use for are null or absent:
//   format "voxweld-scene", version 1, kind "run" (an output directory) or "file"
//   name         of the directory or the file
//   unit, metres_per_unit (null where the unit is unknown)
//   frame        {size, spacing, first, origin, direction, space}, as the manifest has them
//   bounds       {lo, hi}, in the coordinates of the files; null of a file
//   border       "open" where the mesh may end at the volume's border, else "closed"
//   labels_mode  "off", "each" or "shared"
//   labels       [{label, name, colour [r, g, b] linear, triangles, volume, area, bounds}]
//   tiles        [{level, at, box {lo, hi}, triangles, vertices, label, files [{format, path, bytes}]}]
//   merged       [{format, path, bytes}], the files of the whole mesh
//   file         {format, path, bytes}, of kind "file"
//   tileset      "tileset.json" where there is one
//   report       "report.html" where there is one
//   counts, error, refine, made   as the manifest has them
// Labels are text: a number of JavaScript does not hold every one. Paths are relative to /data/.
#pragma once

#include <string>

#include "pipeline/view/served_files.h"

namespace voxweld {

// Where an exported folder has its scene (viewer_folder.h): the address by which the page asks for it.
inline constexpr const char* exported_scene_name = "api/scene";

// InputError or FormatError where the output directory or its lists are not what they should be.
std::string scene_text(const ServedFiles& files);

// InputError where there is nothing that can be shown: a folder that is no output of a run, or a file
// of another format.
void check_viewable(const ServedFiles& files);

}  // namespace voxweld
