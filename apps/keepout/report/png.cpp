// SPDX-License-Identifier: BSD-3-Clause
#include "report/png.h"

#include <png.h>

#include <string>

#include "keepout/error.h"

namespace keepout::app {

std::vector<std::uint8_t> to_png(const Image& image) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.size.width);
  header.height = static_cast<png_uint_32>(image.size.height);
  header.format = PNG_FORMAT_RGBA;

  // The upper bound is known at once; asking for the true size would compress everything twice.
  std::vector<std::uint8_t> bytes(PNG_IMAGE_PNG_SIZE_MAX(header));
  png_alloc_size_t size = bytes.size();
  if (image.rgba.empty() || png_image_write_to_memory(&header, bytes.data(), &size, 0,
                                                      image.rgba.data(), 0, nullptr) == 0) {
    throw Error(std::string("cannot make a PNG picture: ") +
                (image.rgba.empty() ? "it has no pixels" : header.message));
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace keepout::app
