// SPDX-License-Identifier: BSD-3-Clause
#include <embree3/rtcore.h>

#include <array>
#include <atomic>
#include <type_traits>
#include <utility>

#include "../src/centered_frame.h"
#include "../src/index_module.h"
#include "keepout/error.h"
#include "keepout/geometry/shapes.h"

namespace keepout {
namespace {

// In the frame of the scene no coordinate exceeds 1. A vertex is off by half an ulp of a float of
// at most 1, and a center by half an ulp of its coordinates. Embree's distances are off by some ulp
// of themselves. None exceeds 2^-22 of 1 + |center| + radius. Eight times that is added.
constexpr double float_rounding = 0x1p-19;

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
template <class Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

[[noreturn]] void fail(RTCError error) {
  constexpr std::array<const char*, 7> reasons{"no reason given",
                                               "an unknown error",
                                               "an invalid argument",
                                               "an invalid operation",
                                               "out of memory",
                                               "this processor lacks what it needs",
                                               "cancelled"};
  const auto reason = static_cast<std::size_t>(error);
  throw Error(std::string("Embree: ") +
              (reason < reasons.size() ? reasons[reason] : "an unlisted error") +
              "; use the index 'pd_tree', which needs no library");
}

/// Embree's tree, traversed by its point query.
class EmbreeIndex final : public SpatialIndex {
 public:
  explicit EmbreeIndex(std::shared_ptr<const Mesh> on)
      : SpatialIndex(std::move(on)), frame_(mesh().bounds(), 1.0), device_(rtcNewDevice(nullptr)) {
    if (!device_) fail(rtcGetDeviceError(nullptr));
    rtcSetDeviceMemoryMonitorFunction(device_.get(), count_memory, &memory_);
    build();
  }

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    const double reach = padded_radius(ball, mesh().bounds());
    // Tested in double, before distances become too large for floats.
    if (squared_distance(mesh().bounds(), ball.center) > reach * reach) return;
    const Vec3 center = frame_.from_mesh(ball.center);
    const double radius = frame_.from_mesh(ball.radius);
    const double pad = float_rounding * (1.0 + center.cwiseAbs().maxCoeff() + radius);
    // The ball contains every triangle if it reaches the farthest corner of the frame.
    const bool holds_all = radius >= (center.cwiseAbs() + Vec3::Ones()).norm();
    // From farther away floats cannot distinguish triangles. This form also counts NaN as far.
    const bool is_far = !(pad < 1.0);
    if (holds_all || is_far) {
      for (TriangleId t = 0; t < mesh().triangle_count(); ++t) candidates.push(t);
      return;
    }
    RTCPointQuery query;
    query.x = static_cast<float>(center.x());
    query.y = static_cast<float>(center.y());
    query.z = static_cast<float>(center.z());
    query.time = 0.0f;
    query.radius = static_cast<float>(radius + pad);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_.get(), &query, &context, add, &candidates);
  }

  std::size_t memory() const noexcept override {
    return static_cast<std::size_t>(memory_.bytes.load());
  }

 private:
  struct Memory {
    std::atomic<std::ptrdiff_t> bytes{0};  // Embree builds with many threads
  };

  static bool count_memory(void* memory, ssize_t bytes, bool) {
    static_cast<Memory*>(memory)->bytes += bytes;
    return true;
  }

  static bool add(RTCPointQueryFunctionArguments* arguments) {
    static_cast<TriangleBuffer*>(arguments->userPtr)->push(arguments->primID);
    return false;  // the radius does not change
  }

  void build() {
    const Owned<RTCGeometry> geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    check();
    auto* vertices = static_cast<std::array<float, 3>*>(
        rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(std::array<float, 3>), mesh().vertex_count()));
    check();
    for (const Vec3& vertex : mesh().vertices()) {
      const Vec3 local = frame_.from_mesh(vertex);
      *vertices++ = {static_cast<float>(local.x()), static_cast<float>(local.y()),
                     static_cast<float>(local.z())};
    }
    static_assert(sizeof(Corners) == 3 * sizeof(unsigned));
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh().triangles().data(), 0, sizeof(Corners),
                               mesh().triangle_count());
    rtcCommitGeometry(geometry.get());
    check();
    scene_.reset(rtcNewScene(device_.get()));
    check();
    rtcAttachGeometry(scene_.get(), geometry.get());
    rtcCommitScene(scene_.get());
    check();
  }

  void check() const {
    const RTCError error = rtcGetDeviceError(device_.get());
    if (error != RTC_ERROR_NONE) fail(error);
  }

  CenteredFrame frame_;
  Memory memory_;
  // Each index has its own device, so that it counts only its own memory.
  Owned<RTCDevice> device_;
  Owned<RTCScene> scene_;
};

// Embree numbers triangles and vertices by 32 bits, like keepout.
constexpr IndexBackend backends[] = {
    {"embree", "axis-aligned boxes of Embree, in float", make_index_of<EmbreeIndex>, no_triangle,
     [] { return std::string("Embree " RTC_VERSION_STRING); }},
};

}  // namespace

}  // namespace keepout

const std::span<const keepout::IndexBackend> keepout_indices = keepout::backends;
