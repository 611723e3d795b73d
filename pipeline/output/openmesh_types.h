// OpenMesh's half-edge mesh as this folder uses it.
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

namespace voxweld {

struct OpenMeshTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3f;
  HalfedgeAttributes(0);  // no stored previous half-edges: saves 24 bytes a triangle
};
using OpenTriMesh = OpenMesh::TriMesh_ArrayKernelT<OpenMeshTraits>;

}  // namespace voxweld
