#include "tests/fuzz/specimens.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "tests/fuzz/mutation.h"
#include "tests/pipeline/solids/mesh_formats.h"
#include "tests/support/triangle_meshes.h"
#include "tests/support/watched_process.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

constexpr const char* small_work =
    "[work]\nbrick = 16\nshard = 1\nchunk = 16\n[run]\nthreads = 2\nmemory = \"256MiB\"\n";

std::vector<std::string> files_below(const fs::path& folder, const std::string& part) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder / part))
    if (entry.is_regular_file()) files.push_back(fs::relative(entry.path(), folder).string());
  std::sort(files.begin(), files.end());
  return files;
}

class Maker {
 public:
  Maker(const fs::path& program, const fs::path& root) : program_(program), root_(root) {}

  std::vector<Specimen> all() {
    fs::create_directories(root_ / "inputs");
    specimens_ = write_volumes(program_, root_);
    if (!program_.empty()) phantoms();
    write_mesh(root_ / "inputs" / "little.ply", dented_ball({0, 0, 0}, 10, 3));
    meshes();
    configs();
    label_maps();
    if (!program_.empty()) runs();
    return std::move(specimens_);
  }

 private:
  void phantoms() const {
    make("inputs", {"phantom", "gyroid", "--size", "24", "--type", "uint8", "-o", "v.nrrd"});
    make("inputs", {"phantom", "labels", "--size", "24", "--type", "uint8", "-o", "l.nrrd"});
  }

  void runs() {
    const std::string volume = input("v.nrrd") + "[surface]\nisovalue = 127.5\n";
    finished("volume", volume + "inside = \"below\"\n");
    finished("copied", volume + "inside = \"below\"\n", "copy = true\n");
    finished("each", input("l.nrrd") + "[labels]\nmode = \"each\"\n");
    finished("shared", input("l.nrrd") + "[labels]\nmode = \"shared\"\n", "copy = true\n");
    finished("mesh", input("little.ply") + "resolution = 20\n");
  }

  std::string input(const std::string& name) const {
    return fmt::format("[input]\npath = \"{}\"\n", (root_ / "inputs" / name).string());
  }

  void make(const fs::path& folder, const Words& words) const {
    Words command = {program_.string()};
    command.insert(command.end(), words.begin(), words.end());
    const ProcessEnd end = run_watched(command, root_ / folder, root_ / "made", {60});
    if (end.exit_code != 0)
      throw std::runtime_error(fmt::format("{}: {}", shell_text(command), end.err));
  }

  Specimen begin(const std::string& name) const {
    Specimen specimen;
    specimen.name = name;
    specimen.folder = root_ / name;
    fs::create_directories(specimen.folder);
    return specimen;
  }

  // As input, and as a solid to subtract.
  void meshes() {
    for (const std::string& file : mesh_file_names()) {
      Specimen specimen = begin("mesh-" + file);
      write_mesh(specimen.folder / file, dented_ball({0, 0, 0}, 10, 2));
      write_bytes(specimen.folder / "case.toml",
                  fmt::format("[input]\npath = \"{}\"\nresolution = 20\n{}", file, small_work));
      write_bytes(specimen.folder / "edit.toml",
                  fmt::format("{}[surface]\nisovalue = 127.5\ninside = \"below\"\n[[edit]]\n"
                              "op = \"subtract\"\nshape = \"mesh\"\npath = \"{}\"\ncenter = [9, "
                              "12, 12]\n{}[output]\ndirectory = \"case.mesh\"\n",
                              input("v.nrrd"), file, small_work));
      specimen.targets = {file};
      specimen.commands = {{"info", file},
                           {"info", file, "--check"},
                           {"init", file, "--resolution", "16", "-o", "new.toml"},
                           {"run", "case.toml"},
                           {"run", "case.toml", "--set", "input.close=winding"},
                           {"run", "edit.toml"}};
      specimens_.push_back(std::move(specimen));
    }
  }

  void configs() {
    const std::string surface = input("v.nrrd") + "crop = [0, 0, 0, 20, 20, 20]\nspacing = [1, " +
                                "1.5, 2]\nunit = \"mm\"\n[surface]\nisovalue = 127.5\n" +
                                "inside = \"below\"\nborder = \"closed\"\ngradient = \"eno\"\n";
    const std::string rest = std::string("[simplify]\nenabled = true\ntolerance = 0.1\n") +
                             "tolerance_unit = \"voxel\"\nmetric = \"rms\"\n[output]\nformats = " +
                             "[\"drc\", \"glb\"]\nmerged = \"auto\"\ntile_vertices = 2000\n" +
                             "precision = 0.01\n" + small_work;
    const std::string solids =
        "[[edit]]\nop = \"add\"\nshape = \"sphere\"\ncenter = [5, 6, 7]\nradius = 4\n"
        "[[edit]]\nop = \"subtract\"\nshape = \"box\"\ncenter = [12, 12, 12]\nsize = [4, 5, 6]\n"
        "rotate = [10, 20, 30]\n[[edit]]\nop = \"intersect\"\nshape = \"cylinder\"\ncenter = [12, "
        "12, 12]\nradius = 11\nheight = 30\naxis = [0, 1, 1]\n[[edit]]\nshape = \"torus\"\ncenter "
        "= [12, 12, 12]\nradius = 7\ntube = 2\n[[edit]]\nshape = \"cone\"\ncenter = [8, 8, 8]\n"
        "radius = 3\nheight = 6\n[[edit]]\nop = \"subtract\"\nshape = \"plane\"\ncenter = [1, 1, "
        "1]\n";
    const std::string labels = input("l.nrrd") +
                               "[labels]\nmode = \"each\"\nselect = [1, 5, \"10-90\"]\n"
                               "background = [0, 3]\nmin_voxels = 10\nmax_voxels = 1000\n";
    config("config-volume", surface + rest);
    config("config-edits", surface + rest + solids);
    config("config-labels", labels + rest);
    config("config-mesh", input("little.ply") + "cell = 1.0\nmargin = 2\nclose = \"no\"\n" + rest);
  }

  void config(const std::string& name, const std::string& text) {
    Specimen specimen = begin(name);
    write_bytes(specimen.folder / "case.toml", text);
    specimen.targets = {"case.toml"};
    specimen.commands = {{"run", "case.toml"},   {"run", "case.toml", "--dry-run"},
                         {"plan", "case.toml"},  {"status", "case.toml"},
                         {"info", "case.toml"},  {"edit", "case.toml", "--list"},
                         {"ingest", "case.toml"}};
    specimens_.push_back(std::move(specimen));
  }

  void label_maps() {
    const std::string csv =
        "# a map\nlabel,material,name,color\n1,2,left,#ff8000\n3,,gone,\n5,-1,,\n"
        "9,2,\"a, \"\"b\"\"\",\"1,2,3\"\n10-20,7,many,\n";
    const std::string json = R"([{"label": 1, "material": 2, "name": "left", "color": "#ff8000"},
 {"label": "3", "material": null}, {"label": "10-20", "material": 7, "color": [1, 2, 3]}])";
    const std::string slicer = "# names\n0 none 0 0 0 0\n1 one 255 0 0 255\n2 two 0 255 0 255\n";
    const std::string snap = "0 0 0 0 0 0 0 \"none\"\n1 255 0 0 1 1 1 \"one\"\n";
    for (const auto& [file, text] :
         {std::pair{"map.csv", csv}, {"map.json", json}, {"map.ctbl", slicer}, {"map.txt", snap}}) {
      Specimen specimen = begin(std::string("labels-") + file);
      write_bytes(specimen.folder / file, text);
      write_bytes(specimen.folder / "case.toml",
                  fmt::format("{}[labels]\nmode = \"each\"\nmap = \"{}\"\n{}", input("l.nrrd"),
                              file, small_work));
      specimen.targets = {file};
      specimen.commands = {{"run", "case.toml"},
                           {"run", "case.toml", "--set", "labels.mode=shared"},
                           {"run", "case.toml", "--dry-run"}};
      specimens_.push_back(std::move(specimen));
    }
  }

  // A finished run: its work and its output, each to be damaged. The folder gets its name when all
  // is done, so that the copies are of a config that is no longer there, and own themselves.
  void finished(const std::string& name, const std::string& lines, const std::string& work = "") {
    Specimen made = begin("making");
    std::string text = lines + small_work + "[output]\ntile_vertices = 1024\n" +
                       "formats = [\"drc\", \"glb\", \"meshopt\", \"vtp\"]\n";
    if (!work.empty()) text.insert(text.find("[work]\n") + 7, work);
    write_bytes(made.folder / "case.toml", text);
    make(made.folder, {"run", "case.toml"});
    made.clean = output_files(made.folder / "case.mesh");
    const fs::path folder = root_ / ("run-" + name);
    fs::rename(made.folder, folder);
    made.folder = folder;
    add_work(made, name);
    add_output(made, name);
  }

  void add_work(Specimen specimen, const std::string& name) {
    specimen.name = "work-" + name;
    specimen.targets = files_below(specimen.folder, "case.work");
    // "@": the file that was changed. A run makes the output again from what is there.
    specimen.commands = {{"info", "@"},
                         {"info", "@", "--check"},
                         {"info", "case.work", "--check"},
                         {"run", "case.toml"},
                         {"run", "case.toml"},
                         {"run", "case.toml", "--set", "output.formats=[\"drc\"]"},
                         {"stitch", "case.toml"},
                         {"status", "case.toml"}};
    specimens_.push_back(std::move(specimen));
  }

  void add_output(Specimen specimen, const std::string& name) {
    specimen.name = "output-" + name;
    specimen.targets = files_below(specimen.folder, "case.mesh");
    // Lists and the whole mesh as often as all tiles.
    std::vector<std::string> again;
    for (const std::string& file : specimen.targets)
      if (file.find("tiles/") == std::string::npos && file.find("labels/") == std::string::npos)
        again.insert(again.end(), 4, file);
    specimen.targets.insert(specimen.targets.end(), again.begin(), again.end());
    specimen.commands = {
        {"verify", "case.mesh"},
        {"verify", "case.mesh", "--json"},
        {"info", "case.mesh"},
        {"info", "case.mesh", "--check"},
        {"info", "@"},
        {"info", "@", "--check"},
        {"export", "@", "-o", "new.ply"},
        {"render", "@", "-o", "new.png", "--width", "24", "--height", "24"},
        {"render", "case.mesh", "-o", "new.png", "--width", "24", "--height", "24"},
        {"report", "case.mesh", "-o", "new.html"},
        {"run", "case.toml"}};
    specimens_.push_back(std::move(specimen));
  }

  fs::path program_, root_;
  std::vector<Specimen> specimens_;
};

}  // namespace

std::map<std::string, std::string> output_files(const fs::path& output) {
  std::map<std::string, std::string> files;
  if (!fs::is_directory(output)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(output)) {
    const std::string name = fs::relative(entry.path(), output).string();
    if (entry.is_regular_file() && name != "manifest.json" && name != "report.html")
      files[name] = bytes_of_file(entry.path());
  }
  return files;
}

std::vector<Specimen> make_specimens(const fs::path& program, const fs::path& root) {
  return Maker(program, root).all();
}

}  // namespace voxweld::testing
