// SPDX-License-Identifier: BSD-3-Clause
// Unpacking a mesh from a page gives a bitwise identical mesh.
#include "page/packed_mesh.h"

#include <random>

#include "apps/page/unpacked_page.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/mesh/load_mesh.h"
#include "page/base64.h"
#include "page/gzip.h"
#include "trials.h"

namespace keepout::app {
namespace {

std::string_view expect_the_same(const Mesh& mesh, const std::string& name) {
  const PackedMesh pack = packed(mesh.vertices(), mesh.triangles());
  EXPECT_TRUE(test::same_bits(
      test::unpacked(pack.coordinates, pack.bytes, mesh.vertex_count(), mesh.triangle_count()),
      mesh))
      << name;
  return pack.coordinates;
}

TEST(PackedMesh, EveryShapeComesBack) {
  for (const Shape& shape : shapes_to_try()) {
    expect_the_same(Mesh(make_shape(shape.name)), std::string(shape.name));
  }
}

TEST(PackedMesh, RealMeshesComeBackAsFloats) {
  for (const char* name : {"skull", "aneurysm", "brain"}) {
    EXPECT_EQ(expect_the_same(*load_mesh(fixture_path(name)).mesh, name), "float32");
  }
}

TEST(PackedMesh, OneCoordinateThatIsNoFloatMakesAllDoubles) {
  const std::vector<Corners> one{{0, 1, 2}};
  const Vec3 x = Vec3::UnitX();
  const Vec3 y = Vec3::UnitY();
  EXPECT_EQ(expect_the_same(Mesh({{x, y, -0.0 * x}, one}), "-0"), "float32");
  for (const double number : {0.1, -1e30, 1e-60, std::numeric_limits<double>::denorm_min()}) {
    EXPECT_EQ(expect_the_same(Mesh({{x, y, Vec3(1.0, number, 1.0)}, one}), "a double"), "float64");
  }
  for (const float number : {0.1F, std::numeric_limits<float>::denorm_min(), -0x1p99F}) {
    EXPECT_EQ(expect_the_same(Mesh({{x, y, Vec3(1.0, number, 1.0)}, one}), "a float"), "float32");
  }
}

TEST(PackedMesh, VerticesMayBeNumberedInAnyOrderAndUsedByNone) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t count = 3 + random() % 40;
    Surface surface;
    for (std::size_t i = 0; i < count; ++i) {
      surface.vertices.emplace_back(random() % 1000, random() % 1000, random() % 1000);
    }
    const auto any = [&] { return static_cast<VertexId>(random() % count); };
    for (std::size_t i = 0; i < count; ++i) surface.triangles.push_back({any(), any(), any()});
    expect_the_same(Mesh(surface), "at random");
  }
}

TEST(Gzipped, BytesOfAnyLengthComeBack) {
  std::mt19937 random(8);
  for (const std::size_t length : {0UL, 1UL, 1000UL, 65'536UL, 400'000UL}) {
    std::vector<std::uint8_t> noise(length);
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random());
    EXPECT_EQ(test::gunzipped(gzipped(noise)), noise) << length;
    const std::vector<std::uint8_t> zeros(length);
    EXPECT_EQ(test::gunzipped(gzipped(zeros)), zeros) << length;
  }
  EXPECT_LT(gzipped(std::vector<std::uint8_t>(400'000)).size(), 1000U);
}

TEST(Base64, IsThatOfTheStandard) {
  const auto encode = [](const std::string& text) {
    return to_base64(std::vector<std::uint8_t>(text.begin(), text.end()));
  };
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace keepout::app
