// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "base64.h"
#include "report/png.h"
#include "report/raster.h"
#include "report/shading.h"
#include "report/tube.h"
#include "report/views.h"
#include "report_scene.h"

namespace keepout::app {
namespace {

TEST(Png, DecodesBackToTheSamePixels) {
  Image image({7, 5});
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    image.rgba[i] = static_cast<std::uint8_t>(i * 37 % 251);
  }
  const std::vector<std::uint8_t> file = to_png(image);

  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&header, file.data(), file.size()), 0);
  EXPECT_EQ(header.width, 7U);
  EXPECT_EQ(header.height, 5U);
  header.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(header));
  ASSERT_NE(png_image_finish_read(&header, nullptr, pixels.data(), 0, nullptr), 0);
  EXPECT_EQ(pixels, image.rgba);
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

/// Looks down the z axis; a pixel is a millimetre, the middle of the picture is the origin.
Camera from_above() { return look_from(Vec3::UnitZ(), Vec3::UnitY(), Vec3::Zero(), 20.0); }
constexpr ImageSize small = {20, 20};

TEST(Raster, ATriangleCoversItsPixelsAndNoOthers) {
  const Mesh mesh({{{-6, -6, 0}, {6, -6, 0}, {-6, 6, 0}}, {{0, 1, 2}}});
  const Image image = shade(rasterize(mesh, from_above(), small, Interior::hollow));
  for (int row = 0; row < 20; ++row) {
    for (int column = 0; column < 20; ++column) {
      const double x = column + 0.5 - 10.0, y = 10.0 - row - 0.5;
      const double within = std::min({x + 6.0, y + 6.0, -(x + y) / std::sqrt(2.0)});
      if (std::abs(within) < 0.75) continue;  // the edge may be blended
      EXPECT_EQ(image.pixel(column, row)[3], within > 0.0 ? 255 : 0) << x << ", " << y;
    }
  }
}

TEST(Raster, TheNearerSurfaceShowsWhateverTheOrder) {
  for (const auto& [first, second] : {std::pair{1.0, 4.0}, {4.0, 1.0}}) {
    const Mesh mesh(together(square(first, 8), square(second, 8)));
    const Samples samples = rasterize(mesh, from_above(), small, Interior::hollow);
    EXPECT_FLOAT_EQ(samples.depth[samples.at(20, 20)], 4.0F * Samples::per_pixel);
  }
}

TEST(Raster, TheBackOfATriangleShowsAsTheInside) {
  const Mesh mesh(flipped(square(0, 8)));
  const Samples samples = rasterize(mesh, from_above(), small, Interior::hollow);
  EXPECT_EQ(samples.shown[samples.at(20, 20)], Shown::inside);
}

TEST(Raster, ACutThroughASolidShowsAFlatSectionAtTheCut) {
  Surface surface = tetrahedron();
  for (Vec3& v : surface.vertices) v = 8.0 * v - Vec3(2, 2, 2);  // legs from -2 to 6
  const Mesh mesh(std::move(surface));
  Camera camera = from_above();
  camera.cut = Cut{{Vec3(-5, 0, 1), Vec3(5, 0, 1)}, 0, Vec3::UnitY()};
  const Samples samples = rasterize(mesh, camera, small, Interior::solid);
  const std::size_t in_solid = samples.at(20, 20), beside = samples.at(25, 20);
  EXPECT_EQ(samples.shown[in_solid], Shown::section);
  EXPECT_FLOAT_EQ(samples.depth[in_solid], 2.0F);
  EXPECT_EQ(samples.shown[beside], Shown::outside);  // the slanted face, below the cut
}

TEST(Tube, InFrontIsSeenBehindIsNotAndInsideIsSeenThroughTheSurface) {
  const Mesh mesh(square(0, 8));
  const Samples samples = rasterize(mesh, from_above(), small, Interior::hollow);
  const auto drawn = [&](double z, Tube::Sight sight) {
    const Tube tube{
        .points = {{-5, 0, z}, {5, 0, z}}, .radius = 2.0, .color = alarm_color, .sight = sight};
    return draw_tubes(samples, from_above(), std::span(&tube, 1));
  };
  const Image front = drawn(3, Tube::Sight::hidden_by_surface);
  EXPECT_EQ(front.pixel(10, 10)[3], 255);
  EXPECT_GT(front.pixel(10, 10)[0], 4 * front.pixel(10, 10)[1]);  // red
  EXPECT_EQ(front.pixel(10, 4)[3], 0);                            // beside it
  EXPECT_EQ(drawn(-3, Tube::Sight::hidden_by_surface).pixel(10, 10)[3], 0);
  const Image inside = drawn(-3, Tube::Sight::through_surface);
  EXPECT_EQ(inside.pixel(10, 10)[3], 255);
  EXPECT_GT(inside.pixel(10, 10)[0], 4 * inside.pixel(10, 10)[1]);
}

}  // namespace
}  // namespace keepout::app
