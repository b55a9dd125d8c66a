# pangaea_library(name SOURCES a.cc ... DEPS other ...): one static library per folder, sources listed by name.
function(pangaea_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  if(ARG_SOURCES)
    add_library(${name} STATIC ${ARG_SOURCES})
    target_link_libraries(${name} PUBLIC pangaea_settings ${ARG_DEPS})
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE pangaea_settings ${ARG_DEPS})
  endif()
endfunction()

# pangaea_program(name SOURCES ... DEPS ...): an executable, placed in <build>/bin.
function(pangaea_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE pangaea_settings ${ARG_DEPS})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
endfunction()

# pangaea_module(name SOURCES ... DEPS ...): a shared library that programs open when they need it
# (common/base/module.h), placed in <build>/lib. Only its table is seen from outside; a library that it was not made
# for is noticed when it is opened (-z now).
function(pangaea_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_library(${name} MODULE ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE pangaea_settings tl::expected ${ARG_DEPS})
  target_link_options(${name} PRIVATE -Wl,-z,now)
  set_target_properties(${name} PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()

# Seconds. Sanitizers slow the longest tests down by ten and more.
set(PANGAEA_TEST_TIMEOUT 600)
if(PANGAEA_SANITIZE)
  set(PANGAEA_TEST_TIMEOUT 1800)
endif()

# pangaea_test(name SOURCES ... DEPS ...): a GoogleTest program whose tests ctest lists one by one.
function(pangaea_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE pangaea_settings ${ARG_DEPS} GTest::gmock_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/test-bin)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT ${PANGAEA_TEST_TIMEOUT})
endfunction()

# pangaea_benchmark(name SOURCES ... DEPS ...): a google-benchmark program, built with -DPANGAEA_BENCHMARKS=ON.
function(pangaea_benchmark name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  if(NOT PANGAEA_BENCHMARKS)
    return()
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE pangaea_settings ${ARG_DEPS} benchmark::benchmark_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bench-bin)
endfunction()
