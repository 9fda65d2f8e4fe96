// SPDX-License-Identifier: Apache-2.0
#include "client/render/image_io.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace {

// A PNG of a few pixels may inflate to GiBs, which the library keeps before it looks.
thread_local std::size_t mostImageBytes = SIZE_MAX;

void* boundedRealloc(void* memory, std::size_t bytes) {
  return bytes > mostImageBytes ? nullptr : std::realloc(memory, bytes);
}

}  // namespace

#define STBI_MALLOC(bytes) boundedRealloc(nullptr, bytes)
#define STBI_REALLOC(memory, bytes) boundedRealloc(memory, bytes)
#define STBI_FREE(memory) std::free(memory)
#define STBI_ONLY_PNG
#define STBI_MAX_DIMENSIONS 8192
#define STB_IMAGE_STATIC
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#ifdef __clang__
// The library copies no bytes to or from a null pointer where a chunk is empty.
#pragma clang attribute push(__attribute__((no_sanitize("nonnull-attribute"))), apply_to = function)
#endif
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#ifdef __clang__
#pragma clang attribute pop
#endif
#pragma GCC diagnostic pop

#include <algorithm>
#include <fstream>
#include <iterator>
#include <memory>
#include <system_error>
#include <vector>

namespace limn {

Result<void> writePng(const std::filesystem::path& path, const Image& image) {
  if (image.width < 1 || image.height < 1 ||
      image.rgba.size() !=
          4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    return fail(ErrorCode::kInvalidArgument, "there is no picture to write to " + path.string());
  }
  std::vector<char> bytes;
  const auto append = [](void* context, void* data, int size) {
    auto& out = *static_cast<std::vector<char>*>(context);
    const char* first = static_cast<const char*>(data);
    out.insert(out.end(), first, first + size);
  };
  if (stbi_write_png_to_func(
          append,
          &bytes,
          image.width,
          image.height,
          4,
          image.rgba.data(),
          4 * image.width) == 0) {
    return fail(ErrorCode::kIo, "cannot encode the picture " + path.string());
  }
  // Only a regular file is replaced: renaming onto a device or pipe would destroy it.
  std::error_code unknown;
  const bool replaces =
      !std::filesystem::exists(path, unknown) || (std::filesystem::is_regular_file(path, unknown) &&
                                                  !std::filesystem::is_symlink(path, unknown));
  std::filesystem::path partial = path;
  if (replaces) partial += ".part";
  std::ofstream file(partial, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  std::error_code failed;
  if (file && replaces) std::filesystem::rename(partial, path, failed);
  if (!file || failed) {
    std::error_code ignored;
    if (replaces) std::filesystem::remove(partial, ignored);
    return fail(
        ErrorCode::kIo,
        "cannot write " + path.string() +
            ": check that the folder exists, may be written and has room");
  }
  return {};
}

Result<Image> readPng(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return fail(ErrorCode::kNotFound, "cannot open the picture " + path.string());
  const std::vector<char> bytes{
      std::istreambuf_iterator<char>(file),
      std::istreambuf_iterator<char>()};
  if (bytes.size() > (std::size_t{64} << 20)) {
    return fail(ErrorCode::kLimitExceeded, path.string() + " is larger than 64 MiB");
  }
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0;
  int height = 0;
  int channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data, size, &width, &height, &channels, 4),
      stbi_image_free);
  if (!pixels) {
    return fail(
        ErrorCode::kCorrupt,
        path.string() + " is not a PNG of at most 8192x8192 pixels: " + stbi_failure_reason());
  }
  Image image{width, height, {}};
  image.rgba.assign(
      pixels.get(),
      pixels.get() + 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  return image;
}

Result<Image> decodePng(std::span<const std::uint8_t> bytes, const PngShape& shape) {
  const auto size = static_cast<int>(std::min<std::size_t>(bytes.size(), std::size_t{1} << 30));
  int w = 0;
  int h = 0;
  int channels = 0;
  // The size is looked at before anything is decoded.
  if (stbi_info_from_memory(bytes.data(), size, &w, &h, &channels) == 0 || w != shape.width ||
      h != shape.height || channels != shape.channels) {
    return fail(
        ErrorCode::kCorrupt,
        "an image of the stream has not the size or the channels that it should");
  }
  // At most four channels of 16 bits, and what belongs to the file itself.
  const std::size_t pixelBytes = 8 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
  mostImageBytes = pixelBytes + 2 * bytes.size() + (std::size_t{1} << 16);
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes.data(), size, &w, &h, &channels, 4),
      stbi_image_free);
  mostImageBytes = SIZE_MAX;
  if (!pixels) return fail(ErrorCode::kCorrupt, "an image of the stream is damaged");
  Image image{w, h, {}};
  image.rgba.assign(
      pixels.get(),
      pixels.get() + 4 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
  return image;
}

}  // namespace limn
