#include "pipeline/ingest/mesh_ingest.h"

namespace voxweld {
namespace {

class MeshIngest final : public StageWork {
 public:
  MeshIngest(const Config& config, StreamedMesh& mesh) : config_(config), mesh_(mesh) {}

  Stage stage() const override { return Stage::ingest; }
  std::string noun() const override { return "meshes"; }
  std::string identity() const override { return mesh_.binning.folder.filename().string(); }
  std::uint64_t size() const override { return 1; }
  std::vector<Unit> units(std::span<const std::uint64_t> numbers) const override {
    return std::vector<Unit>(numbers.size(), Unit{0, "mesh " + mesh_.path.filename().string(),
                                                  static_cast<double>(mesh_.record.triangles)});
  }
  bool done(std::uint64_t) override { return bins_are_current(mesh_); }
  std::string missing_text(const StageLook&) const override {
    return "the mesh is not cut up into bricks";
  }

  StageMemory memory(std::span<const std::uint64_t>) override { return streaming_memory(); }
  // What reading the file has left is of use to the one who goes on with it here.
  void open(RunContext& context, const StageLook& look) override {
    if (look.current() || !context.executor->in_process()) mesh_.spooled.reset();
  }
  void run(const Unit&, WorkerContext& worker) override {
    make_bins(config_, mesh_, worker.interrupt());
  }
  void end(RunContext&) override { mesh_.spooled.reset(); }

 private:
  const Config& config_;
  StreamedMesh& mesh_;
};

}  // namespace

std::unique_ptr<StageWork> mesh_ingest(const Config& config, StreamedMesh& mesh) {
  return std::make_unique<MeshIngest>(config, mesh);
}

}  // namespace voxweld
