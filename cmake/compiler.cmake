# C++20, every warning an error, optional sanitizer.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

# Assertions stay on in every build: NDEBUG is never set, Eigen's own checks are switched off where it matters below.
string(REPLACE "-DNDEBUG" "" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")
string(REPLACE "-O3" "-O2" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")

add_library(waymark_warnings INTERFACE)
target_compile_options(waymark_warnings INTERFACE -Wall -Wextra -Wpedantic -Werror)
# Fused multiply-add contraction would let two compilers round the same source differently.
target_compile_options(waymark_warnings INTERFACE -ffp-contract=off)
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  target_compile_definitions(waymark_warnings INTERFACE EIGEN_NO_DEBUG)
endif()

# GCC collects its garbage from 400 MB on: an eighth less time per source, for 30 MB more at most in those that need most.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-heapsize=400000>)
endif()

option(WAYMARK_FUZZ "a libFuzzer binary for each parser (clang)" OFF)
if(WAYMARK_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

set(WAYMARK_SANITIZE "" CACHE STRING "address, undefined, thread, several with commas, or empty")
if(WAYMARK_SANITIZE)
  add_compile_options(-fsanitize=${WAYMARK_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${WAYMARK_SANITIZE})
  # A sanitizer's own dlopen looks for modules along the program's RPATH, but not its RUNPATH.
  add_link_options(LINKER:--disable-new-dtags)
  # GCC's manual: the sanitizers' code lets this warning see paths that cannot be taken (in <regex>, for one).
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  if(WAYMARK_SANITIZE MATCHES "undefined")
    # Without this UBSan prints and exits 0.
    add_compile_options(-fno-sanitize-recover=all)
    add_link_options(-fno-sanitize-recover=all)
  endif()
  # ctest reads it in, and every test inherits it, whatever programs it starts.
  configure_file(${PROJECT_SOURCE_DIR}/cmake/sanitizer_options.cmake.in
                 ${PROJECT_BINARY_DIR}/sanitizer_options.cmake @ONLY)
  set_property(DIRECTORY ${PROJECT_SOURCE_DIR}
               APPEND PROPERTY TEST_INCLUDE_FILES ${PROJECT_BINARY_DIR}/sanitizer_options.cmake)
endif()
