// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/maps/png.h"

#include <zlib.h>

#include <cstdlib>

namespace {

/// stb's own deflate has no codes of its own for a file, and takes half as much again.
unsigned char* deflated(unsigned char* data, int size, int* outSize, int /*quality*/) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, MAX_WBITS, MAX_MEM_LEVEL, Z_FILTERED) !=
      Z_OK) {
    return nullptr;
  }
  const uLong most = deflateBound(&stream, static_cast<uLong>(size));
  auto* out = static_cast<unsigned char*>(std::malloc(most));  // stb frees it
  if (out != nullptr) {
    stream.next_in = data;
    stream.avail_in = static_cast<uInt>(size);
    stream.next_out = out;
    stream.avail_out = static_cast<uInt>(most);
    deflate(&stream, Z_FINISH);
    *outSize = static_cast<int>(stream.total_out);
  }
  deflateEnd(&stream);
  return out;
}

}  // namespace

#define STBIW_ZLIB_COMPRESS deflated
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace limn {

std::vector<std::uint8_t>
encodePng(int width, int height, int channels, std::span<const std::uint8_t> texels) {
  std::vector<std::uint8_t> bytes;
  const auto append = [](void* context, void* data, int size) {
    auto& out = *static_cast<std::vector<std::uint8_t>*>(context);
    const auto* first = static_cast<const std::uint8_t*>(data);
    out.insert(out.end(), first, first + size);
  };
  if (stbi_write_png_to_func(
          append,
          &bytes,
          width,
          height,
          channels,
          texels.data(),
          channels * width) == 0)
    bytes.clear();
  return bytes;
}

}  // namespace limn
