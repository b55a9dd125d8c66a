# Every third-party library, in one place. All of them are Debian packages; scripts/setup installs them.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(OpenCV 4.6 REQUIRED COMPONENTS core imgproc imgcodecs features2d video)
find_package(Ceres 2.1 REQUIRED)
find_package(CycloneDDS 0.10 REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(spdlog REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tl-expected REQUIRED)
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)
find_library(XXHASH_LIBRARY xxhash REQUIRED)
find_path(DEFLATE_INCLUDE_DIR libdeflate.h REQUIRED)
find_library(DEFLATE_LIBRARY deflate REQUIRED)

# OpenCV's headers warn under C++20, so they are system headers here.
add_library(pangaea_opencv INTERFACE)
target_include_directories(pangaea_opencv SYSTEM INTERFACE ${OpenCV_INCLUDE_DIRS})
target_link_libraries(pangaea_opencv INTERFACE ${OpenCV_LIBS})

add_library(pangaea_xxhash INTERFACE)
target_include_directories(pangaea_xxhash SYSTEM INTERFACE ${XXHASH_INCLUDE_DIR})
target_link_libraries(pangaea_xxhash INTERFACE ${XXHASH_LIBRARY})

add_library(pangaea_deflate INTERFACE)
target_include_directories(pangaea_deflate SYSTEM INTERFACE ${DEFLATE_INCLUDE_DIR})
target_link_libraries(pangaea_deflate INTERFACE ${DEFLATE_LIBRARY})
