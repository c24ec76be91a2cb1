set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo" FORCE)
endif()

option(PATINA_BUILD_TESTS "Build the tests" ON)
option(PATINA_BUILD_BENCHMARKS "Build the benchmarks" OFF)
option(PATINA_WARNINGS_AS_ERRORS "Stop at the first warning" OFF)
set(PATINA_SANITIZE "" CACHE STRING "Sanitizers, as -fsanitize takes them: address,undefined or thread")

find_program(PATINA_CCACHE ccache)
if(PATINA_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${PATINA_CCACHE}")
endif()

# The program is the one file a user starts: build/vdb-patina.
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}")

add_library(patina_options INTERFACE)
target_compile_options(patina_options INTERFACE -Wall -Wextra -Wpedantic)
if(PATINA_WARNINGS_AS_ERRORS)
  target_compile_options(patina_options INTERFACE -Werror)
endif()
# Same input, same bits: no contraction into fused multiply-adds that one machine has and another lacks.
target_compile_options(patina_options INTERFACE -ffp-contract=off)
if(PATINA_SANITIZE)
  target_compile_options(patina_options INTERFACE -fsanitize=${PATINA_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all -g1)
  # OpenVDB shifts negative coordinates to the left, which C++20 defines.
  if(PATINA_SANITIZE MATCHES "undefined")
    target_compile_options(patina_options INTERFACE -fno-sanitize=shift)
  endif()
  target_link_options(patina_options INTERFACE -fsanitize=${PATINA_SANITIZE})
endif()
