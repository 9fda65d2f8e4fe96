// SPDX-License-Identifier: Apache-2.0
#include "shared/gl/api.h"

#include <string>

namespace limn::gl {

Result<Api> loadApi(GetProcAddress getProcAddress) {
  Api api;
#define LIMN_GL_LOAD(member, name, type)                                                    \
  api.member = reinterpret_cast<type>(getProcAddress("gl" #name));                          \
  if (api.member == nullptr) {                                                              \
    return fail(                                                                            \
        ErrorCode::kUnavailable,                                                            \
        "the GL library lacks gl" #name ", which GLES 3.0 has: install a newer GL driver"); \
  }
  LIMN_GL_ENTRY_POINTS(LIMN_GL_LOAD)
#undef LIMN_GL_LOAD
  return api;
}

}  // namespace limn::gl
