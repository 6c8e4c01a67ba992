# Every library comes from a Debian package listed in scripts/packages.txt.
# System headers are included as SYSTEM, so that -Werror judges only our own code.
include(core_dependencies)

find_package(Ceres 2.1 REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_program(LCM_GEN lcm-gen REQUIRED)
find_path(LCM_CORETYPES_DIR lcm/lcm_coretypes.h REQUIRED)
pkg_check_modules(LCM REQUIRED IMPORTED_TARGET lcm)
# glib asks for -pthread, which would make another compilation than that of the precompiled headers; glibc needs it no more.
set_property(TARGET PkgConfig::LCM PROPERTY INTERFACE_COMPILE_OPTIONS "")
pkg_check_modules(SODIUM REQUIRED IMPORTED_TARGET libsodium)
pkg_check_modules(SYSTEMD REQUIRED IMPORTED_TARGET libsystemd)
# It has no pkg-config file.
find_path(HPDF_INCLUDE_DIR hpdf.h REQUIRED)
find_library(WAYMARK_HPDF hpdf REQUIRED)
find_package(spdlog REQUIRED)
# Only the video importer links FFmpeg's: each start of a program that does costs 70 MB and 0.1–0.2 s.
pkg_check_modules(LIBAV REQUIRED IMPORTED_TARGET libavformat libavcodec libavutil libswscale)

# Referees of core/detect. OpenCV's CMake configuration comes only with libopencv-dev, which pulls in VTK, HDF5 and GTK;
# modules are declared one by one.
pkg_check_modules(APRILTAG REQUIRED IMPORTED_TARGET apriltag)
find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
function(waymark_opencv_module module)
  find_library(OPENCV_${module} opencv_${module} REQUIRED)
  add_library(opencv::${module} UNKNOWN IMPORTED GLOBAL)
  set_target_properties(opencv::${module} PROPERTIES IMPORTED_LOCATION ${OPENCV_${module}}
                        INTERFACE_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE_DIR})
endfunction()
foreach(module core imgproc aruco)
  waymark_opencv_module(${module})
endforeach()

if(WAYMARK_BAGS)
  pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET liblz4)
  pkg_check_modules(SQLITE REQUIRED IMPORTED_TARGET sqlite3)
  pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
  find_package(ZLIB REQUIRED)
endif()
if(WAYMARK_TESTS)
  find_package(GTest REQUIRED)
  find_package(Boost 1.74 REQUIRED)
  foreach(module calib3d imgcodecs)
    waymark_opencv_module(${module})
  endforeach()
  # They write with one library what is read with another.
  find_package(JPEG REQUIRED)
  find_package(PNG REQUIRED)
  find_package(ZLIB REQUIRED)
endif()
if(WAYMARK_JAVA)
  find_file(LCM_JAR lcm.jar PATHS /usr/share/java NO_DEFAULT_PATH REQUIRED)
  find_program(JAVAC javac REQUIRED)
endif()
# The report page is bundled with npm's packages and tested in a browser.
if(WAYMARK_REPORT_PAGE)
  find_program(NODE NAMES node nodejs REQUIRED)
  find_program(NPM npm REQUIRED)
  if(WAYMARK_TESTS)
    find_program(CHROMIUM NAMES chromium chromium-browser REQUIRED)
  endif()
endif()
