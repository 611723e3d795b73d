#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <exception>
#include <memory>

#include "storage/image/image_service.h"
#include "storage/image/oiio_reader.h"
#include "storage/modules/module_api.h"

namespace voxweld {
namespace {

class OiioModule final : public Module, public ImageService {
 public:
  OiioModule() {
    // The caller decides on parallelism; a pool of its own would also hold memory of its own.
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
  }

  ImageService* images() override { return this; }

  ImageModuleReader* open(const std::string& path, int level, std::string& error) override try {
    if (level > 0) {
      error = "has no resolutions to choose from";
      return nullptr;
    }
    return OiioReader::open(path, error).release();
  } catch (const std::exception& failure) {
    error = failure.what();
    return nullptr;
  }

  bool encode_png(const PngImage& image, std::span<const std::byte> pixels,
                  std::vector<unsigned char>& out, std::string& error) override try {
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("png");
    if (!output) {
      error = OIIO::geterror();
      return false;
    }
    OIIO::Filesystem::IOVecOutput memory(out);
    output->set_ioproxy(&memory);
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height),
                         image.channels, OIIO::TypeUInt8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    const bool done = output->open("image.png", spec) &&
                      output->write_image(OIIO::TypeUInt8, pixels.data()) && output->close();
    if (!done) error = output->geterror();
    return done;
  } catch (const std::exception& failure) {
    error = failure.what();
    return false;
  }
};

Module* module() {
  static OiioModule module;
  return &module;
}

}  // namespace
}  // namespace voxweld

const voxweld::ModuleEntry voxweld_module_entry = {voxweld::module_version, voxweld::module};
