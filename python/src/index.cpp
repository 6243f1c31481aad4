// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "arrays.h"
#include "batch.h"
#include "bindings.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/index/index_cache.h"
#include "keepout/index/query.h"

namespace keepout::python {
namespace {

std::shared_ptr<const SpatialIndex> build(const std::string& name,
                                          const std::shared_ptr<const Mesh>& mesh,
                                          const std::optional<std::filesystem::path>& cache) {
  const auto tell = [](const std::string& text) {
    const py::gil_scoped_acquire acquire;
    warn(text);
  };
  const py::gil_scoped_release release;
  if (name == "wide_bvh" && cache && !cache->empty()) return load_or_build(mesh, *cache, tell);
  return make_index(name, mesh);
}

std::shared_ptr<const SpatialIndex> refit(const IndexHandle& before,
                                          const std::shared_ptr<const Mesh>& mesh) {
  const py::gil_scoped_release release;
  if (auto index = before.index->refitted(mesh)) return index;
  return make_index(before.name, mesh);
}

Ball ball_of(py::handle center, double radius) {
  const Ball ball{point(center, "center"), radius};
  if (!ball.center.allFinite()) refuse("center", "finite numbers", "NaN or infinity");
  if (!(radius >= 0.0) || !std::isfinite(radius)) {
    refuse("radius", "a finite number not below zero", std::to_string(radius));
  }
  return ball;
}

/// Returns all candidates, with as much capacity as they need.
TriangleBuffer candidates_in(const IndexHandle& index, const Ball& ball) {
  const std::size_t all = index.mesh->triangle_count();
  for (std::size_t room = std::min<std::size_t>(all, 1024);; room = std::min(all, 8 * room)) {
    TriangleBuffer candidates(room);
    index.index->collect(ball, candidates);
    if (!candidates.overflowed() || room == all) return candidates;
  }
}

py::array_t<TriangleId> query(const IndexHandle& index, const py::object& center, double radius) {
  TriangleBuffer candidates = candidates_in(index, ball_of(center, radius));
  std::sort(candidates.begin(), candidates.end());
  return py::array_t<TriangleId>(static_cast<py::ssize_t>(candidates.size()), candidates.begin());
}

/// Exact hits for Python.
struct Hits {
  Vec3 center;
  std::vector<Hit> hits;
};

Hits hits_in(const IndexHandle& index, const py::object& center, double radius) {
  const Ball ball = ball_of(center, radius);
  const TriangleBuffer candidates = candidates_in(index, ball);
  HitBuffer hits(std::max<std::size_t>(candidates.size(), 1));
  refine(*index.mesh, ball, candidates.view(), hits);
  return {ball.center, {hits.begin(), hits.end()}};
}

py::array_t<double> points_of(const Hits& self) {
  py::array_t<double> points({static_cast<py::ssize_t>(self.hits.size()), py::ssize_t{3}});
  double* to = points.mutable_data();
  for (const Hit& hit : self.hits) {
    const Vec3 at = self.center + hit.closest.offset;
    to = std::copy_n(at.data(), 3, to);
  }
  return points;
}

/// Returns the distance from each point to the mesh; NaN for a point that is not finite.
py::array_t<double> distances(const IndexHandle& index, const py::object& points,
                              std::optional<py::ssize_t> threads) {
  const Doubles from = doubles(points, {"points", {any, 3}, "(n, 3)"});
  const auto size = static_cast<std::size_t>(from.shape(0));
  py::array_t<double> result(from.shape(0));
  const double* const tips = from.data();
  double* const to = result.mutable_data();
  const unsigned workers = threads_for(size, threads);
  const py::gil_scoped_release release;
  run_batch(size, 64, workers,
            [&](unsigned, std::size_t begin, std::size_t end, const std::stop_token& stop) {
              NearestTriangle nearest(*index.mesh, *index.index);
              double guess = 0.0;
              for (std::size_t i = begin; i < end && !stop.stop_requested(); ++i) {
                const Vec3 tip = row(tips, i);
                // The guess saves time and does not change the result.
                guess = tip.allFinite() ? nearest(tip, guess).closest.distance : 0.0;
                to[i] = tip.allFinite() ? guess : std::nan("");
              }
            });
  return result;
}

}  // namespace

std::shared_ptr<IndexHandle> index_from(const py::object& mesh, const py::object& index,
                                        const std::optional<std::filesystem::path>& cache) {
  const std::shared_ptr<const Mesh>& surface = mesh_of(mesh);
  if (py::isinstance<IndexHandle>(index)) {
    auto shared = index.cast<std::shared_ptr<IndexHandle>>();
    if (shared->mesh != surface) {
      refuse("index", "an Index of the same Mesh object", "one of another mesh");
    }
    return shared;
  }
  if (!py::isinstance<py::str>(index)) {
    refuse("index", "a name of indices(), or a keepout.Index", Py_TYPE(index.ptr())->tp_name);
  }
  return std::make_shared<IndexHandle>(mesh, index.cast<std::string>(), cache);
}

IndexHandle::IndexHandle(py::object on, std::string part,
                         const std::optional<std::filesystem::path>& cache)
    : mesh_object(std::move(on)),
      mesh(mesh_of(mesh_object)),
      name(std::move(part)),
      index(build(name, mesh, cache)) {}

IndexHandle::IndexHandle(py::object moved, const IndexHandle& before)
    : mesh_object(std::move(moved)),
      mesh(mesh_of(mesh_object)),
      name(before.name),
      index(refit(before, mesh)) {}

void bind_index(py::module_& module) {
  py::class_<Hits> hits(
      module, "Hits",
      "The triangles that touch a ball, sorted by number, and the closest point of each to the\n"
      "center. Arrays are read-only views.");
  add_view(
      hits, "triangles", &Hits::hits, 1, [](const Hit& hit) { return &hit.triangle; },
      "(k,) uint32: the numbers of the triangles.");
  add_view(
      hits, "offsets", &Hits::hits, 3, [](const Hit& hit) { return hit.closest.offset.data(); },
      "(k, 3) float64: from the center to the closest points, to full precision [length].");
  add_view(
      hits, "distances", &Hits::hits, 1, [](const Hit& hit) { return &hit.closest.distance; },
      "(k,) float64: from the center to the closest points [length].");
  hits.def_property_readonly("points", &points_of,
                             "(k, 3) float64: the closest points, center + offset [length].")
      .def("__len__", [](const Hits& self) { return self.hits.size(); })
      .def("__repr__", [](const Hits& self) {
        return "<keepout.Hits: " + std::to_string(self.hits.size()) + " triangles>";
      });

  py::class_<IndexHandle, std::shared_ptr<IndexHandle>>(
      module, "Index",
      "Finds the triangles near a point. Any number of motion constraints, in any threads, may\n"
      "share an index.\n"
      "\n"
      "name: one of indices().\n"
      "cache: a directory that keeps built indices for the next start; only wide_bvh uses it.")
      .def(py::init<py::object, std::string, const std::optional<std::filesystem::path>&>(),
           py::arg("mesh"), py::arg("name") = "wide_bvh", py::kw_only(),
           py::arg("cache") = py::none())
      .def("query", &query, py::arg("center"), py::arg("radius"),
           "Returns (k,) uint32: every triangle that touches the ball, and possibly others,\n"
           "sorted.\n"
           "\n"
           "center: (3,) [length]; radius >= 0 [length].")
      .def("hits", &hits_in, py::arg("center"), py::arg("radius"),
           "Returns exactly the triangles that touch the ball, and their closest points: bitwise\n"
           "identical for every index.\n"
           "\n"
           "center: (3,) [length]; radius >= 0 [length].")
      .def("distances", &distances, py::arg("points"), py::kw_only(),
           py::arg("threads") = py::none(),
           R"(Returns (n,) float64: the distance from each point to the mesh [length]; NaN for a
point that is not finite. Runs without Python's lock, on all processors unless `threads` is given.

points: (n, 3) [length].)")
      .def(
          "refitted",
          [](const IndexHandle& self, py::object mesh) {
            return std::make_shared<IndexHandle>(std::move(mesh), self);
          },
          py::arg("mesh"),
          "Returns an index of the same type for a mesh with the same triangles whose vertices\n"
          "have moved. For wide_bvh it takes about a tenth of the time of a build. Does not\n"
          "change this index: see MotionConstraint.follow.")
      .def_readonly("mesh", &IndexHandle::mesh_object, "The mesh.")
      .def_readonly("name", &IndexHandle::name, "The name in indices().")
      .def_property_readonly(
          "memory", [](const IndexHandle& self) { return self.index->memory(); },
          "The memory of the index, without the mesh [bytes].")
      .def("__repr__", [](const IndexHandle& self) {
        return py::str("<keepout.Index '{}' of {} triangles>")
            .format(self.name, self.mesh->triangle_count());
      });
}

}  // namespace keepout::python
