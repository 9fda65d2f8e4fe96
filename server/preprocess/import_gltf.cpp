// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/import_readers.h"

namespace limn::import {

Result<ImportedMesh> readGltf(std::string_view) {
  return fail(ErrorCode::kUnsupported, "glTF is not read yet: export PLY, OBJ, STL or OFF");
}

}  // namespace limn::import
