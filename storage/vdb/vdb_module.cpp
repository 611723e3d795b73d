// The module libvoxweld_vdb.so.
#include "storage/modules/reader_module.h"
#include "storage/vdb/vdb_source.h"

namespace voxweld {
namespace {

Module* vdb_module() {
  static ReaderModule module({{.name = "vdb", .files = {}, .test = {}, .open = open_vdb}});
  return &module;
}

}  // namespace
}  // namespace voxweld

const voxweld::ModuleEntry voxweld_module_entry = {voxweld::module_version, voxweld::vdb_module};
