# One way to declare each kind of target.
if(WAYMARK_TESTS)
  include(GoogleTest)
endif()
include(GNUInstallDirs)

# Modules are found in one folder of the build, and below lib/ of an installation.
set(WAYMARK_MODULE_FOLDER ${PROJECT_BINARY_DIR}/modules)
set(CMAKE_BUILD_RPATH ${WAYMARK_MODULE_FOLDER})
set(CMAKE_INSTALL_RPATH $ORIGIN/../lib/waymark)

# Headers that nearly every source includes are compiled once for all of them. Sources still include what they use:
# scripts/check builds without.
function(waymark_precompile target headers)
  if(WAYMARK_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM waymark_precompiled_${headers})
  endif()
endfunction()
if(WAYMARK_PRECOMPILED_HEADERS)
  set(empty ${PROJECT_BINARY_DIR}/precompiled_headers.cc)
  file(GENERATE OUTPUT ${empty} CONTENT "")
  add_library(waymark_precompiled_common OBJECT ${empty})
  target_precompile_headers(waymark_precompiled_common PRIVATE ${PROJECT_SOURCE_DIR}/cmake/precompiled_common.h)
  target_link_libraries(waymark_precompiled_common PRIVATE Eigen3::Eigen fmt::fmt tl::expected waymark_warnings)
endif()
if(WAYMARK_PRECOMPILED_HEADERS AND WAYMARK_TESTS)
  add_library(waymark_precompiled_tests OBJECT ${empty})
  target_precompile_headers(waymark_precompiled_tests PRIVATE ${PROJECT_SOURCE_DIR}/cmake/precompiled_tests.h)
  target_link_libraries(waymark_precompiled_tests PRIVATE Eigen3::Eigen fmt::fmt tl::expected GTest::gmock waymark_warnings)
endif()

# waymark_library(<name> SOURCES … PUBLIC … PRIVATE …): a static library, included from the top of the tree.
function(waymark_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:waymark_warnings>)
  waymark_precompile(${name} common)
endfunction()

# waymark_core_library(…): one that programs outside this tree may link, too: Waymark::<name without waymark_> after
# find_package(Waymark); see core/CMakeLists.txt.
function(waymark_core_library name)
  waymark_library(${name} ${ARGN})
  string(REPLACE waymark_ "" exported ${name})
  set_target_properties(${name} PROPERTIES EXPORT_NAME ${exported})
  target_include_directories(${name} PUBLIC $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/waymark>)
  install(TARGETS ${name} EXPORT waymark_core COMPONENT core ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
endfunction()

# waymark_module(<name> COMPONENT … SOURCES … PRIVATE …): loaded at run time by those that need it (dlopen), so that
# the others do not pay for the libraries behind it.
function(waymark_module name)
  cmake_parse_arguments(ARG "" "COMPONENT" "SOURCES;PRIVATE" ${ARGN})
  add_library(${name} MODULE ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${WAYMARK_MODULE_FOLDER}
                                           INSTALL_RPATH "")
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_PRIVATE} waymark_warnings)
  install(TARGETS ${name} DESTINATION lib/waymark COMPONENT ${ARG_COMPONENT})
endfunction()

# waymark_program(<name> SOURCES … PRIVATE …)
function(waymark_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PRIVATE" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_PRIVATE} waymark_warnings)
  waymark_precompile(${name} common)
endfunction()

# waymark_test(<name> SOURCES … LIBS … [LABELS …] [TIMEOUT seconds]): GoogleTest cases, one ctest line each.
function(waymark_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LIBS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_LIBS} GTest::gtest_main GTest::gmock waymark_warnings)
  waymark_precompile(${name} tests)
  set(properties TIMEOUT ${ARG_TIMEOUT})
  if(ARG_LABELS)  # an empty value would vanish and shift what follows it
    list(APPEND properties LABELS "${ARG_LABELS}")
  endif()
  gtest_discover_tests(${name} NO_PRETTY_VALUES TEST_PREFIX "${name}/" DISCOVERY_TIMEOUT 60
                       PROPERTIES ${properties})
endfunction()
