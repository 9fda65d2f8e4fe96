// SPDX-License-Identifier: Apache-2.0
#include "client/apps/output_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

namespace limn {

Result<void> writeOutputFile(const std::filesystem::path& path, std::string_view bytes) {
  const auto fault = [&path](const std::string& why) {
    return fail(ErrorCode::kIo, "cannot write " + path.string() + ": " + why);
  };
  std::error_code error;
  // Devices and pipes (/dev/stdout) cannot be replaced; they are written to.
  const auto status = std::filesystem::status(path, error);
  const bool direct = std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
  if (std::filesystem::is_directory(status)) return fault("it is a directory");
  std::filesystem::path aside = path;
  if (!direct) aside += ".part" + std::to_string(::getpid());
  std::ofstream out(aside, std::ios::binary);
  if (!out) return fault(std::strerror(errno));
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (out.fail()) {
    const std::string why = std::strerror(errno);
    if (!direct) std::filesystem::remove(aside, error);
    return fault(why);
  }
  if (direct) return {};
  std::filesystem::rename(aside, path, error);
  if (error) {
    const std::string why = error.message();
    std::filesystem::remove(aside, error);
    return fault(why);
  }
  return {};
}

}  // namespace limn
