# SPDX-License-Identifier: Apache-2.0
# Compiler settings that every target of the project shares.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")

find_program(LIMN_CCACHE ccache)
if(LIMN_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${LIMN_CCACHE}")
endif()

if(LIMN_SANITIZE)
  add_compile_options(-fsanitize=${LIMN_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${LIMN_SANITIZE})
endif()
