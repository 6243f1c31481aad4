// SPDX-License-Identifier: BSD-3-Clause
#include "report/png.h"

#include <png.h>

#include <string_view>

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

std::string to_base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) -> std::uint32_t {
      return i + k < bytes.size() ? bytes[i + k] : 0U;
    };
    const std::uint32_t group = byte(0) << 16U | byte(1) << 8U | byte(2);
    text += digits[group >> 18U & 63U];
    text += digits[group >> 12U & 63U];
    text += i + 1 < bytes.size() ? digits[group >> 6U & 63U] : '=';
    text += i + 2 < bytes.size() ? digits[group & 63U] : '=';
  }
  return text;
}

}  // namespace keepout::app
