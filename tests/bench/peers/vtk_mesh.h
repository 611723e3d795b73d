// VTK's mesh as ours.
#pragma once

#include <vtkCellArray.h>
#include <vtkPolyData.h>

#include "peer_files.h"

namespace peers {

inline Mesh mesh_of(vtkPolyData& data) {
  Mesh mesh;
  mesh.vertices.resize(static_cast<std::size_t>(data.GetNumberOfPoints()));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    double point[3];
    data.GetPoint(static_cast<vtkIdType>(i), point);
    for (std::size_t axis = 0; axis < 3; ++axis)
      mesh.vertices[i][axis] = static_cast<float>(point[axis]);
  }
  mesh.triangles.resize(static_cast<std::size_t>(data.GetNumberOfPolys()));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    vtkIdType corners = 0;
    const vtkIdType* corner = nullptr;
    data.GetPolys()->GetCellAtId(static_cast<vtkIdType>(i), corners, corner);
    for (std::size_t k = 0; k < 3; ++k)
      mesh.triangles[i][k] = static_cast<std::uint32_t>(corner[k]);
  }
  return mesh;
}

}  // namespace peers
