// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <BulletCollision/BroadphaseCollision/btQuantizedBvh.h>
#include <BulletCollision/CollisionShapes/btStridingMeshInterface.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>

#include "../src/centered_frame.h"
#include "keepout/error.h"
#include "keepout/mesh/mesh.h"

// Debian ships Bullet in both precisions, and the one links with headers set for the other.
static_assert(sizeof(btScalar) == sizeof(double), "Bullet is used in double precision");

namespace keepout {

/// The mesh as Bullet's trees read it when they are built: in a centered frame, without a copy, and
/// in parts of as many triangles as a quantised node can number.
class BulletMesh final : public btStridingMeshInterface {
 public:
  static constexpr int bits_in_part = 31 - MAX_NUM_PARTS_IN_BITS;

  BulletMesh(const Mesh& mesh, const CenteredFrame& frame) : mesh_(mesh), frame_(frame) {}

  static btVector3 bullet(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

  /// The triangle that Bullet knows by its part and its number in it.
  static TriangleId triangle(int part, int number) {
    return (static_cast<TriangleId>(part) << bits_in_part) | static_cast<TriangleId>(number);
  }

  btVector3 low() const { return bullet(frame_.from_mesh(mesh_.bounds().low)); }
  btVector3 high() const { return bullet(frame_.from_mesh(mesh_.bounds().high)); }

  void InternalProcessAllTriangles(btInternalTriangleIndexCallback* callback, const btVector3&,
                                   const btVector3&) const override {
    for (TriangleId t = 0; t < mesh_.triangle_count(); ++t) {
      btVector3 corners[3];
      for (int i = 0; i < 3; ++i) corners[i] = bullet(frame_.from_mesh(mesh_.triangle(t)[i]));
      callback->internalProcessTriangleIndex(corners, static_cast<int>(t >> bits_in_part),
                                             static_cast<int>(t & ((1u << bits_in_part) - 1)));
    }
  }

  // The rest is asked for by other users of such a mesh, never by a tree.
  void getLockedVertexIndexBase(unsigned char**, int&, PHY_ScalarType&, int&, unsigned char**, int&,
                                int&, PHY_ScalarType&, int) override {
    refuse();
  }
  void getLockedReadOnlyVertexIndexBase(const unsigned char**, int&, PHY_ScalarType&, int&,
                                        const unsigned char**, int&, int&, PHY_ScalarType&,
                                        int) const override {
    refuse();
  }
  void unLockVertexBase(int) override {}
  void unLockReadOnlyVertexBase(int) const override {}
  int getNumSubParts() const override {
    return static_cast<int>((mesh_.triangle_count() - 1) >> bits_in_part) + 1;
  }
  void preallocateVertices(int) override {}
  void preallocateIndices(int) override {}

 private:
  [[noreturn]] static void refuse() { throw Error("this Bullet asks for a copy of the mesh"); }

  const Mesh& mesh_;
  const CenteredFrame& frame_;
};

}  // namespace keepout
