# Every library comes from a Debian package listed in scripts/packages.txt.
# System headers are included as SYSTEM, so that -Werror judges only our own code.
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Ceres 2.1 REQUIRED)

# OpenCV's CMake configuration comes only with libopencv-dev, which pulls in VTK, HDF5 and GTK;
# the modules needed here are declared one by one. Only the video importer links videoio and only
# tests link imgcodecs: each start of a program that does costs 70 MB and 0.1–0.2 s.
find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(module core imgproc calib3d aruco imgcodecs videoio)
  find_library(OPENCV_${module} opencv_${module} REQUIRED)
  add_library(opencv::${module} UNKNOWN IMPORTED)
  set_target_properties(opencv::${module} PROPERTIES IMPORTED_LOCATION ${OPENCV_${module}}
                        INTERFACE_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE_DIR})
endforeach()

find_package(yaml-cpp 0.7 REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(tl-expected REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(GTest REQUIRED)
find_package(Boost 1.74 REQUIRED)
pkg_check_modules(APRILTAG REQUIRED IMPORTED_TARGET apriltag)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
find_program(LCM_GEN lcm-gen REQUIRED)
find_path(LCM_CORETYPES_DIR lcm/lcm_coretypes.h REQUIRED)
find_file(LCM_JAR lcm.jar PATHS /usr/share/java NO_DEFAULT_PATH REQUIRED)
pkg_check_modules(LCM REQUIRED IMPORTED_TARGET lcm)
# glib asks for -pthread, which would make another compilation than that of the precompiled headers; glibc needs it no more.
set_property(TARGET PkgConfig::LCM PROPERTY INTERFACE_COMPILE_OPTIONS "")
pkg_check_modules(SYSTEMD REQUIRED IMPORTED_TARGET libsystemd)
find_package(spdlog REQUIRED)

# The report page is bundled with npm's packages and tested in a browser.
find_program(NODE NAMES node nodejs REQUIRED)
find_program(NPM npm REQUIRED)
find_program(CHROMIUM NAMES chromium chromium-browser REQUIRED)
