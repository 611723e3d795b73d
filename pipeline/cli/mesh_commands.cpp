// verify, render and export: what is done with an output directory or a mesh file.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "pipeline/cli/command_text.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/number_option.h"
#include "pipeline/cli/output_file.h"
#include "pipeline/executor/progress.h"
#include "pipeline/executor/prompt_stop.h"
#include "pipeline/neuroglancer/folder_check.h"
#include "pipeline/neuroglancer/folder_reader.h"
#include "pipeline/neuroglancer/neuroglancer.h"
#include "pipeline/output/distance_colours.h"
#include "pipeline/output/export.h"
#include "pipeline/output/load.h"
#include "pipeline/output/render.h"
#include "pipeline/output/verify.h"
#include "pipeline/output/wide_mesh.h"
#include "storage/image/image_file.h"
#include "storage/manifest/manifest.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

struct RenderArguments {
  std::string input;
  OutputFile output;
  RenderOptions options;
  std::vector<double> centre;
  int level = 0;
  std::string distance_to;  // empty: not asked for
  std::optional<double> distance_end;
};

struct VerifyArguments {
  std::string directory;
  VerifyOptions options;
  bool json = false, no_merged = false, no_origin = false;
};

struct ExportArguments {
  std::string input;
  OutputFile output;
  ExportOptions options;
  bool neuroglancer = false;
  NeuroglancerOptions folder;
};

// Neither over something that is there nor over one of the meshes that are read.
void check_output(const OutputFile& output, const std::string& input) {
  std::error_code error;
  if (std::filesystem::exists(output.path, error))
    each_mesh_file(input, [&](const std::filesystem::path& mesh, std::optional<Material>) {
      refuse_input(output.path, mesh);
    });
  check_free(output.path, output.force);
}

struct Picture {
  Image image;
  std::optional<ShownDistances> distances;
};

Picture draw(const RenderArguments& arguments, const InterruptFlag& interrupt) {
  const PromptStop prompt(interrupt);
  RenderOptions options = arguments.options;
  options.places = !arguments.distance_to.empty();
  if (const auto end = arguments.distance_end; end && !(*end > 0))
    throw InputError(
        fmt::format("cannot render: --distance-end is {}, expected a number above 0", *end));
  if (!arguments.centre.empty())
    options.centre = Vec3{arguments.centre[0], arguments.centre[1], arguments.centre[2]};
  // Two passes over the files, one mesh in memory at a time: bounds, then the picture.
  GrowingBounds bounds;
  using Draw = std::function<void(const DecodedMesh&, std::optional<Material>)>;
  const auto each = [&](const Draw& f) {
    for_each_mesh(
        arguments.input,
        [&](const DecodedMesh& mesh, std::optional<Material> label) {
          interrupt.check();
          f(mesh, label);
        },
        mesh_writers(), arguments.level);
  };
  each([&](const DecodedMesh& mesh, std::optional<Material>) { bounds.add(mesh); });
  Renderer renderer(bounds.bounds(), options);
  renderer.set_colours(listed_colours(arguments.input));
  each([&](const DecodedMesh& mesh, std::optional<Material> label) { renderer.draw(mesh, label); });
  Picture picture;
  if (options.places)
    picture.distances = ReferenceMesh(arguments.distance_to, bounds.bounds())
                            .colour(renderer, arguments.distance_end);
  picture.image = renderer.finish();
  return picture;
}

std::vector<std::uint8_t> with_alpha(const Image& image) {
  std::vector<std::uint8_t> pixels;
  pixels.reserve(4 * image.alpha.size());
  for (std::size_t i = 0; i < image.alpha.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) pixels.push_back(image.rgb[3 * i + k]);
    pixels.push_back(image.alpha[i]);
  }
  return pixels;
}

int render(const RenderArguments& arguments, const Program& program) {
  const std::string& output = arguments.output.path;
  check_ending(output, std::vector<std::string>{".png"}, "a picture");
  check_output(arguments.output, arguments.input);
  const Picture picture = draw(arguments, program.interrupt);
  const Image& image = picture.image;
  program.interrupt.check();
  const bool opaque = image.alpha.empty();
  const std::vector<std::uint8_t> pixels = opaque ? image.rgb : with_alpha(image);
  write_png(output, {image.width, image.height, opaque ? 3 : 4}, std::as_bytes(std::span(pixels)));
  fmt::print("{}: {} x {}\n", output, image.width, image.height);
  if (const auto& shown = picture.distances)
    fmt::print(
        "distance of what is seen: {:.3g} in the mean, 99 % within {:.3g}, at most {:.3g}; "
        "yellow from {:.3g} on\n",
        shown->mean, shown->p99, shown->most, shown->end);
  return 0;
}

void add_level(CLI::App& command, int& level) {
  add_value(command, "--level", level,
            "The level of detail, of an output directory that has some; 0: the mesh itself");
}

int export_one(const ExportArguments& arguments, const Program& program) {
  const std::string& output = arguments.output.path;
  check_export_name(output);
  check_output(arguments.output, arguments.input);
  std::string text;
  std::size_t triangles = 0;
  {
    const PromptStop prompt(program.interrupt);
    const ExportOptions& options = arguments.options;
    const bool plain =
        !options.weld && !options.world && !std::filesystem::is_directory(arguments.input);
    const auto mesh = plain ? std::optional(load_mesh(arguments.input)) : std::nullopt;
    if (mesh && mesh->pairs.empty()) {
      text = exported_mesh(*mesh, output);
      triangles = mesh->triangles.size();
    } else {
      const WideMesh wide = load_wide_mesh(arguments.input, options);
      text = exported_wide_mesh(wide, output);
      triangles = wide.triangles.size();
    }
  }
  write_exported(output, text, &program.interrupt);
  fmt::print("{}: {}\n", output, counted(triangles, "triangles"));
  return 0;
}

int verify_export(const VerifyArguments& arguments) {
  const VerifyOptions& options = arguments.options;
  if (arguments.no_merged || arguments.no_origin || options.intersections)
    throw InputError(arguments.directory +
                     ": is an export for Neuroglancer; of the options only --threads and --json "
                     "are for one");
  const FolderReport report = check_folder(arguments.directory, options.threads, options.interrupt);
  fmt::print("{}", arguments.json ? to_json_text(report) : to_text(report));
  return report.good() ? 0 : 1;
}

int export_folder(const ExportArguments& arguments, const Program& program) {
  NeuroglancerOptions options = arguments.folder;
  options.force = arguments.output.force;
  options.interrupt = &program.interrupt;
  const std::string& folder = arguments.output.path;
  if (std::filesystem::is_regular_file(arguments.input))
    throw InputError(arguments.input +
                     ": is a file; --neuroglancer takes the output directory of a finished run");
  const NeuroglancerTotals totals = write_neuroglancer(arguments.input, folder, options);
  if (totals.left_out_zero)
    spdlog::warn("label 0 is left out: Neuroglancer takes no segment of this number");
  fmt::print("{}: {} in {} of {}, {}\n", folder, counted(totals.objects, "objects"),
             counted(totals.fragments, "fragments"),
             counted(static_cast<std::uint64_t>(totals.levels), "levels"),
             counted(totals.triangles, "triangles"));
  if (totals.no_unit)
    spdlog::warn("the input names no unit that is known: one counts as a nanometre");
  fmt::print(
      "next: serve the folder over HTTP, and name precomputed://http://.../{} in Neuroglancer\n",
      std::filesystem::path(folder).filename().string());
  return 0;
}

void add_neuroglancer_options(CLI::App& command, ExportArguments& arguments) {
  CLI::Option* neuroglancer = command.add_flag(
      "--neuroglancer", arguments.neuroglancer,
      "Writes a folder of meshes for Neuroglancer, of an output directory: an object "
      "for each label, with all levels of detail that there are");
  CLI::Option* sharded =
      command
          .add_flag("--sharded", arguments.folder.sharded,
                    "With --neuroglancer: puts many objects into one file, for many labels")
          ->needs(neuroglancer);
  command
      .add_flag(
          "--legacy", arguments.folder.legacy,
          "With --neuroglancer: writes the old format, which has one level and no compression")
      ->needs(neuroglancer)
      ->excludes(sharded);
  add_value(command, "--threads", arguments.folder.threads,
            "With --neuroglancer: threads to use; 0: all there are")
      ->check(whole_number())
      ->needs(neuroglancer);
  for (const char* other : {"--weld", "--level", "--world"})
    neuroglancer->excludes(command.get_option(other));
}

}  // namespace

void add_verify_command(CLI::App& app, Program& program) {
  auto arguments = std::make_shared<VerifyArguments>();
  CLI::App* command = app.add_subcommand(
      "verify",
      "Checks that the meshes of a run are closed and complete\n"
      "Reads everything in an output directory again: files, counts and checksums as the manifest "
      "lists them, each tile and the whole a closed manifold, tiles equal to the bit where they "
      "meet. Where the input and the config are still there, they have to be those that the meshes "
      "were made of. Of an export for Neuroglancer it decodes all fragments, and each level of "
      "each object has to be closed; of the options --threads and --json are for one. Exits with "
      "1 where something is wrong.");
  add_examples(*command, {{"voxweld verify scan.mesh", ""}, {"voxweld verify scan.ng", ""}});
  add_file(*command, "directory", arguments->directory,
           "The output directory of a finished run, or an export for Neuroglancer");
  add_value(*command, "--threads", arguments->options.threads, "Threads to use; 0: all there are")
      ->check(whole_number());
  command->add_flag("--no-merged", arguments->no_merged,
                    "Leaves out the file with the whole mesh, which needs memory for all of it");
  command->add_flag("--no-origin", arguments->no_origin,
                    "Leaves out whether the input and the config are as they were");
  command->add_flag("--intersections", arguments->options.intersections,
                    "Also counts pairs of triangles that intersect, exactly, and triangles without "
                    "an area. They are told and are no problem of the output");
  command->add_flag("--json", arguments->json, "Prints the report as JSON");
  when_chosen(*command, program, [&program, arguments] {
    arguments->options.merged = !arguments->no_merged;
    arguments->options.origin = !arguments->no_origin;
    arguments->options.interrupt = &program.interrupt;
    const PromptStop prompt(program.interrupt);
    if (is_export_folder(arguments->directory)) return verify_export(*arguments);
    require_output(arguments->directory);
    const VerifyReport report = verify_output(arguments->directory, arguments->options);
    fmt::print("{}", arguments->json ? to_json_text(report) : to_text(report));
    return report.good() ? 0 : 1;
  });
}

void add_render_command(CLI::App& app, Program& program) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App* command = app.add_subcommand(
      "render",
      "Draws a picture of meshes, as PNG\n"
      "z points up; one mesh is in memory at a time, so an output directory may be of any size.");
  add_examples(*command,
               {{"voxweld render scan.mesh -o scan.png", ""},
                {"voxweld render scan.mesh -o inside.png --azimuth 120 --cut-y 80",
                 "from another side, without what lies beyond y = 80"},
                {"voxweld render scan.mesh -o error.png --level 2 --distance-to scan.mesh",
                 "how far level 2 is from the mesh itself"},
                {"voxweld render scan.mesh -o net.png --edges --transparent",
                 "how large the triangles are, to be laid over something else"}});
  RenderOptions& o = arguments->options;
  add_file(*command, "input", arguments->input,
           "An output directory, or a mesh file: " + endings_text(mesh_writers()));
  add_output_file(*command, arguments->output, "The PNG to write");
  add_value(*command, "--width", o.width, "Pixels");
  add_value(*command, "--height", o.height, "Pixels");
  add_value(*command, "--azimuth", o.azimuth, "Degrees around z; 0 looks along +y");
  add_value(*command, "--elevation", o.elevation, "Degrees above the horizon");
  add_value(*command, "--zoom", o.zoom, "At 1 the whole mesh fits");
  add_numbers(*command, "--centre", arguments->centre, {3},
              "The point in the middle of the picture, x, y, z in the mesh's unit (default: the "
              "middle of the mesh)");
  add_value(*command, "--field-of-view", o.field_of_view, "Degrees; 0: orthographic");
  command->add_option("--cut-x", o.cut[0], "Leaves out what lies above this x, to look inside");
  command->add_option("--cut-y", o.cut[1], "The same for y");
  command->add_option("--cut-z", o.cut[2], "The same for z");
  add_level(*command, arguments->level);
  CLI::Option* to =
      command
          ->add_option("--distance-to", arguments->distance_to,
                       "Colours by the distance to this mesh, an output directory or a file in the "
                       "same frame: dark purple is none. It is held in memory")
          ->type_name("MESH");
  command
      ->add_option(
          "--distance-end", arguments->distance_end,
          "The distance from which on colours are yellow, in the mesh's unit (default: that "
          "which 99 % of what is seen has)")
      ->needs(to);
  command->add_flag("--edges", o.edges, "Draws the edges of triangles");
  command->add_flag("--transparent", o.transparent, "Leaves the background transparent");
  when_chosen(*command, program, [&program, arguments] { return render(*arguments, program); });
}

void add_export_command(CLI::App& app, Program& program) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand(
      "export",
      "Converts a mesh to .ply, .obj, .stl or .off, or for Neuroglancer\n"
      "A .ply has the label of each face where the mesh has labels: `label` on its inner side, "
      "`label_outside` on the other where both sides have one; -1 is the space around the volume.");
  add_examples(*command, {{"voxweld export scan.mesh/mesh.drc -o scan.ply", ""},
                          {"voxweld export scan.mesh -o scan.ply --weld --world",
                           "all tiles as one mesh, in the scanner's coordinates"},
                          {"voxweld export scan.mesh --neuroglancer -o scan.ng",
                           "a folder that Neuroglancer reads"}});
  add_file(*command, "input", arguments->input,
           "A mesh file: " + endings_text(mesh_writers()) + "; or an output directory");
  add_output_file(*command, arguments->output,
                  "The file to write; its ending says how. With --neuroglancer: the folder");
  command->add_flag("--weld", arguments->options.weld,
                    "One vertex for each position, without normals; else a vertex at a crease "
                    "appears once for each of its normals");
  add_level(*command, arguments->options.level);
  command->add_flag("--world", arguments->options.world,
                    "The coordinates of the scanner's world, as frame in manifest.json has them; "
                    "doubles, but for .stl");
  add_neuroglancer_options(*command, *arguments);
  when_chosen(*command, program, [&program, arguments] {
    return arguments->neuroglancer ? export_folder(*arguments, program)
                                   : export_one(*arguments, program);
  });
}

}  // namespace voxweld
