# Debian's LCM has no CMake package, and its lcm.pc wants GLib's development files: it is found by its parts.
find_path(LCM_INCLUDE_DIR lcm/lcm-cpp.hpp REQUIRED)
find_library(LCM_LIBRARY lcm REQUIRED)
find_program(LCM_GEN lcm-gen REQUIRED)
add_library(pangaea_liblcm INTERFACE)
target_include_directories(pangaea_liblcm SYSTEM INTERFACE ${LCM_INCLUDE_DIR})
target_link_libraries(pangaea_liblcm INTERFACE ${LCM_LIBRARY})

# pangaea_lcm_types(name PACKAGE package FILES a.lcm ...): headers <package>/a.hpp by lcm-gen. A file holds the one
# struct that it is named after.
function(pangaea_lcm_types name)
  cmake_parse_arguments(ARG "" "PACKAGE" "FILES" ${ARGN})
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/lcm_types)
  set(headers)
  foreach(file ${ARG_FILES})
    get_filename_component(struct ${file} NAME_WE)
    set(header ${folder}/${ARG_PACKAGE}/${struct}.hpp)
    add_custom_command(OUTPUT ${header}
      COMMAND ${LCM_GEN} --cpp --cpp-hpath ${folder} ${CMAKE_CURRENT_SOURCE_DIR}/${file}
      DEPENDS ${file} VERBATIM)
    list(APPEND headers ${header})
  endforeach()
  add_custom_target(${name}_headers DEPENDS ${headers})
  add_library(${name} INTERFACE)
  add_dependencies(${name} ${name}_headers)
  target_include_directories(${name} SYSTEM INTERFACE ${folder})
  target_link_libraries(${name} INTERFACE pangaea_liblcm)
endfunction()
