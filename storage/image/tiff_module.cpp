#include <exception>
#include <memory>

#include "storage/image/image_service.h"
#include "storage/image/ome_parse.h"
#include "storage/image/tiff_reader.h"
#include "storage/modules/module_api.h"

namespace voxweld {
namespace {

class TiffModule final : public Module, public ImageService {
 public:
  ImageService* images() override { return this; }

  ImageModuleReader* open(const std::string& path, int level, std::string& error) override try {
    return TiffReader::open(path, level, error).release();
  } catch (const std::exception& failure) {
    error = failure.what();
    return nullptr;
  }

  bool read_ome(const std::string& xml, OmeMetadata& out, std::string& error) override {
    return parse_ome(xml, out, error);
  }
};

Module* module() {
  static TiffModule module;
  return &module;
}

}  // namespace
}  // namespace voxweld

const voxweld::ModuleEntry voxweld_module_entry = {voxweld::module_version, voxweld::module};
