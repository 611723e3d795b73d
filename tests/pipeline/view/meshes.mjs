// The surfaces that the test of the page looks at.
import { copyFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

// run(...arguments): the program, in the folder `place`.
export function make_meshes(place, run) {
  run("phantom", "gyroid", "--size", "48", "-o", "gyroid.nrrd");
  writeFileSync(join(place, "gyroid.toml"),
    `[input]\npath = "gyroid.nrrd"\nspacing = [0.5, 0.5, 0.5]\nunit = "mm"\n[surface]\nisovalue = 32767.5\ninside = "below"\n[output]\ntile_vertices = 3000\nformats = ["drc", "glb", "vtp"]\nmerged = true\n`);
  run("run", "gyroid.toml");
  run("phantom", "labels", "--size", "40", "--type", "uint16", "-o", "cells.nrrd");
  run("init", "cells.nrrd", "--labels");
  run("run", "cells.toml");
  run("run", "cells.toml", "--set", "labels.mode=shared", "--set", "output.directory=shared.mesh", "--set", "work.directory=shared.work");
  run("run", "cells.toml", "--set", "labels.mode=shared", "--set", 'output.formats=["ply","vtp"]', "--set", "output.merged=true",
    "--set", "output.tile_vertices=1024", "--set", "output.directory=plain.mesh", "--set", "work.directory=shared.work");
  run("export", "shared.mesh", "-o", "shared.ply");
  run("export", "cells.mesh", "-o", "each.ply");
  for (const ending of ["ply", "stl", "obj"]) run("export", "gyroid.mesh", "-o", `gyroid.${ending}`);
  copyFileSync(join(place, "gyroid.mesh/mesh.glb"), join(place, "gyroid.glb"));
  writeFileSync(join(place, "solids.toml"), // a ball without holes
    `[input]\nformat = "empty"\nsize = [40, 40, 40]\n[[edit]]\nop = "add"\nshape = "sphere"\ncenter = [20, 20, 20]\nradius = 15\n`);
  run("run", "solids.toml");
}
