#include <gdcmTrace.h>

#include "storage/dicom/dicom_probe.h"
#include "storage/dicom/dicom_source.h"
#include "storage/modules/reader_module.h"

namespace voxweld {
namespace {

VolumeReader opening_row() {
  VolumeReader row = dicom_reader();
  row.open = open_dicom;
  return row;
}

Module* module() {
  // What there is to say, messages of ours say.
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  static ReaderModule module({opening_row()});
  return &module;
}

}  // namespace
}  // namespace voxweld

const voxweld::ModuleEntry voxweld_module_entry = {voxweld::module_version, voxweld::module};
