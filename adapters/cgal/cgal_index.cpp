// SPDX-License-Identifier: BSD-3-Clause
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/version.h>

#include <boost/iterator/counting_iterator.hpp>
#include <utility>

#include "../src/index_module.h"
#include "keepout/geometry/shapes.h"

namespace keepout {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;

/// A triangle of the mesh by its id: CGAL's concept AABBPrimitiveWithSharedData.
class MeshTriangle {
 public:
  using Id = TriangleId;
  using Datum = Kernel::Triangle_3;
  using Datum_reference = Datum;
  using Point = Kernel::Point_3;
  using Point_reference = Point;
  using Shared_data = const Mesh*;

  MeshTriangle() = default;
  MeshTriangle(boost::counting_iterator<TriangleId> id, const Mesh*) : id_(*id) {}

  Id id() const { return id_; }
  Datum datum(const Mesh* mesh) const {
    const Triangle corners = mesh->triangle(id_);
    return {point(corners[0]), point(corners[1]), point(corners[2])};
  }
  Point reference_point(const Mesh* mesh) const { return point(mesh->triangle(id_)[0]); }
  static Shared_data construct_shared_data(const Mesh* mesh) { return mesh; }

 private:
  static Point point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

  TriangleId id_ = no_triangle;
};

using Traits = CGAL::AABB_traits<Kernel, MeshTriangle>;
using Tree = CGAL::AABB_tree<Traits>;
using Node = CGAL::AABB_node<Traits>;

/// The queries of CGAL's traversal: enters every node within reach, and takes all its triangles.
struct BallTraversal {
  double squared_reach;
  TriangleBuffer& candidates;

  bool go_further() const { return true; }
  bool do_intersect(const Vec3& center, const Node& node) const {
    const CGAL::Bbox_3& box = node.bbox();
    return squared_distance(
               {Vec3(box.xmin(), box.ymin(), box.zmin()), Vec3(box.xmax(), box.ymax(), box.zmax())},
               center) <= squared_reach;
  }
  void intersection(const Vec3&, const MeshTriangle& triangle) { candidates.push(triangle.id()); }
};

class CgalIndex final : public SpatialIndex {
 public:
  explicit CgalIndex(std::shared_ptr<const Mesh> on) : SpatialIndex(std::move(on)) {
    const auto count = static_cast<TriangleId>(mesh().triangle_count());
    tree_.insert(boost::counting_iterator<TriangleId>(0),
                 boost::counting_iterator<TriangleId>(count), &mesh());
    tree_.build();  // here, so that the first query need not build
  }

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    const double reach = padded_radius(ball, mesh().bounds());
    BallTraversal traversal{reach * reach, candidates};
    tree_.traversal(ball.center, traversal);
  }

  std::size_t memory() const noexcept override {
    return tree_.size() * (sizeof(MeshTriangle) + sizeof(Node));
  }

 private:
  Tree tree_;
};

// CGAL counts in size_t, which is enough for any mesh.
constexpr IndexBackend backends[] = {
    {"cgal", "AABB tree of CGAL", make_index_of<CgalIndex>, no_triangle,
     [] { return std::string("CGAL " CGAL_VERSION_STR); }},
};

}  // namespace

}  // namespace keepout

const std::span<const keepout::IndexBackend> keepout_indices = keepout::backends;
