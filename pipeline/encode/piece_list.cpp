// Based on: Kitware, "VTK File Formats" (2021), section "PPolyData".
#include "pipeline/encode/piece_list.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "stages/encode/vtp.h"
#include "storage/manifest/manifest.h"

namespace voxweld {

void PieceList::add(const AssetRecord& record) {
  for (const FileRecord& file : record.files) {
    if (file.format != "vtp") continue;
    if (!file_) {
      file_.emplace(output_, pieces_name);
      file_->append(as_bytes(std::string(
          "<?xml version=\"1.0\"?>\n<!-- voxweld " VOXWELD_VERSION
          " -->\n<VTKFile type=\"PPolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
          "header_type=\"UInt64\">\n<PPolyData GhostLevel=\"0\">\n")));
    }
    file_->append(as_bytes(fmt::format("<Piece Source=\"{}\"/>\n", file.path)));
  }
  if (!arrays_.between_labels) return;
  Material highest = 0;
  for (const LabelAsset& part : record.labels) highest = std::max(highest, part.label);
  (vtp_label_bits(highest) == 32 ? narrow_ : wide_) = true;
}

std::optional<FileRecord> PieceList::finish() {
  if (!file_) return {};
  if (narrow_ && wide_) {
    spdlog::warn(
        "{}: is left out, since labels of some tiles need 64 bits and those of others do not; open "
        "the .vtp files one by one, or mesh.vtp",
        (output_ / pieces_name).string());
    return {};
  }
  std::string arrays;
  if (arrays_.between_labels)
    arrays = fmt::format(
        "<PCellData Scalars=\"label\">\n<PDataArray type=\"Int{0}\" Name=\"label\"/>\n"
        "<PDataArray type=\"Int{0}\" Name=\"label_outside\"/>\n</PCellData>\n",
        wide_ ? 64 : 32);
  else if (arrays_.normals)
    arrays =
        "<PPointData Normals=\"Normals\">\n<PDataArray type=\"Float32\" Name=\"Normals\" "
        "NumberOfComponents=\"3\"/>\n</PPointData>\n";
  file_->append(as_bytes(
      arrays +
      "<PPoints>\n<PDataArray type=\"Float32\" Name=\"Points\" NumberOfComponents=\"3\"/>\n"
      "</PPoints>\n</PPolyData>\n</VTKFile>\n"));
  FileRecord record = file_->finish("pvtp");
  record.role = "pieces";
  return record;
}

}  // namespace voxweld
