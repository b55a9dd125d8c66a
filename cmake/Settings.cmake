# Language, warnings and code generation, the same for every target.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

# What the sanitizer presets build with: assertions stay in, and -O1 because instrumented Eigen compiles far too slowly
# at -O2.
set(CMAKE_C_FLAGS_SANITIZE "-O1 -g1")
set(CMAKE_CXX_FLAGS_SANITIZE "-O1 -g1")

option(PANGAEA_TESTS "Build the tests" ON)
option(PANGAEA_BENCHMARKS "Build the google-benchmark programs" OFF)
set(PANGAEA_SANITIZE "" CACHE STRING "Sanitizers, for example address,undefined or thread")

# The baseline has popcnt and SSE4.2; wider instructions are chosen at run time where a kernel is worth it
# (docs/decisions/0001-instruction-set.md).
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(PANGAEA_MARCH "x86-64-v2" CACHE STRING "Value of -march; empty for the compiler's default")
else()
  set(PANGAEA_MARCH "" CACHE STRING "Value of -march; empty for the compiler's default")
endif()

add_library(pangaea_settings INTERFACE)
target_include_directories(pangaea_settings INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(pangaea_settings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Werror
  $<$<CXX_COMPILER_ID:Clang>:-Wthread-safety>)
if(PANGAEA_MARCH)
  target_compile_options(pangaea_settings INTERFACE -march=${PANGAEA_MARCH})
endif()
if(PANGAEA_SANITIZE)
  # Instrumented code misleads the analysis behind -Wmaybe-uninitialized.
  target_compile_options(pangaea_settings INTERFACE -fsanitize=${PANGAEA_SANITIZE} -fno-omit-frame-pointer
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(pangaea_settings INTERFACE -fsanitize=${PANGAEA_SANITIZE})
endif()

find_program(PANGAEA_CCACHE ccache)
if(PANGAEA_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${PANGAEA_CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${PANGAEA_CCACHE})
endif()
