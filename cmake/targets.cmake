# One way to declare each kind of target.
if(WAYMARK_TESTS)
  include(GoogleTest)
endif()
include(GNUInstallDirs)

# Modules are found in one folder of the build, and below lib/ of an installation.
set(WAYMARK_MODULE_FOLDER ${PROJECT_BINARY_DIR}/modules)
set(CMAKE_BUILD_RPATH ${WAYMARK_MODULE_FOLDER})
# Not right below lib: what CPack finds there it takes for libraries of all, and has ldconfig called.
set(WAYMARK_INSTALLED_MODULES lib/waymark/modules)
set(CMAKE_INSTALL_RPATH $ORIGIN/../${WAYMARK_INSTALLED_MODULES})

set(WAYMARK_FAST $<$<CONFIG:Release>:-O3>)
# Tests' own sources: they are compiled more often than they run, and spend their time in what they test, which is optimized as ever.
set(WAYMARK_TESTS_OWN $<$<CONFIG:Release>:-O1>)
# Sources that read a command line: large templates that run once.
set(WAYMARK_COMMAND_LINE $<$<CONFIG:Release>:-O1>)

# Headers that nearly every source includes are compiled once for all of them. Sources still include what they use:
# scripts/check builds without. GCC optimizes whatever uses a precompiled header as that header was, so that there is one per kind of
# optimization, and sources with options of their own (waymark_source_options) use none. A folder that sets WAYMARK_PRECOMPILED to
# "mapping" has headers of its own compiled as well.
set(WAYMARK_PRECOMPILED common)
function(waymark_precompiled kind header)
  add_library(waymark_precompiled_${kind} OBJECT ${PROJECT_BINARY_DIR}/precompiled_headers.cc)
  target_precompile_headers(waymark_precompiled_${kind} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/${header})
  target_include_directories(waymark_precompiled_${kind} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(waymark_precompiled_${kind} PRIVATE Eigen3::Eigen fmt::fmt tl::expected waymark_warnings)
endfunction()
if(WAYMARK_PRECOMPILED_HEADERS)
  file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/precompiled_headers.cc CONTENT "")
  waymark_precompiled(common precompiled_common.h)
  waymark_precompiled(mapping precompiled_mapping.h)
  waymark_precompiled(fast precompiled_common.h)
  target_compile_options(waymark_precompiled_fast PRIVATE ${WAYMARK_FAST})
  if(WAYMARK_TESTS)
    waymark_precompiled(common_tests precompiled_tests.h)
    waymark_precompiled(mapping_tests precompiled_mapping_tests.h)
    foreach(kind common_tests mapping_tests)
      target_compile_options(waymark_precompiled_${kind} PRIVATE ${WAYMARK_TESTS_OWN})
      target_link_libraries(waymark_precompiled_${kind} PRIVATE GTest::gmock)
    endforeach()
  endif()
endif()
function(waymark_precompile target kind)
  if(WAYMARK_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM waymark_precompiled_${kind})
  endif()
endfunction()

# waymark_source_options(<option…> SOURCES <source…>): for single sources of the target that is being declared.
function(waymark_source_options)
  cmake_parse_arguments(ARG "" "" "SOURCES" ${ARGN})
  set_source_files_properties(${ARG_SOURCES} PROPERTIES COMPILE_OPTIONS "${ARG_UNPARSED_ARGUMENTS}"
                                                        SKIP_PRECOMPILE_HEADERS ON)
endfunction()

# waymark_fast_sources(<source…>): single sources of the target that is being declared, for small matrices of fixed size as in a FAST
# library, and with its precompiled header, which CMake itself would give to whole targets only.
function(waymark_fast_sources)
  set(options ${WAYMARK_FAST})
  if(WAYMARK_PRECOMPILED_HEADERS AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    set(header ${PROJECT_BINARY_DIR}/CMakeFiles/waymark_precompiled_fast.dir/cmake_pch.hxx)
    list(APPEND options -Winvalid-pch -include ${header})
    set_source_files_properties(${ARGN} PROPERTIES OBJECT_DEPENDS ${header}.gch)
  endif()
  waymark_source_options(${options} SOURCES ${ARGN})
endfunction()

# waymark_library(<name> [FAST] SOURCES … PUBLIC … PRIVATE …): a static library, included from the top of the tree. FAST is for small
# matrices of fixed size: -O3 inlines what -O2 calls.
function(waymark_library name)
  cmake_parse_arguments(ARG "FAST" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:waymark_warnings>)
  if(ARG_FAST)
    target_compile_options(${name} PRIVATE ${WAYMARK_FAST})
    waymark_precompile(${name} fast)
  else()
    waymark_precompile(${name} ${WAYMARK_PRECOMPILED})
  endif()
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
  install(TARGETS ${name} DESTINATION ${WAYMARK_INSTALLED_MODULES} COMPONENT ${ARG_COMPONENT})
endfunction()

# waymark_program(<name> SOURCES … PRIVATE …)
function(waymark_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PRIVATE" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_PRIVATE} waymark_warnings)
  waymark_precompile(${name} ${WAYMARK_PRECOMPILED})
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
  target_compile_options(${name} PRIVATE ${WAYMARK_TESTS_OWN})
  waymark_precompile(${name} ${WAYMARK_PRECOMPILED}_tests)
  set(properties TIMEOUT ${ARG_TIMEOUT})
  if(ARG_LABELS)  # an empty value would vanish and shift what follows it
    list(APPEND properties LABELS "${ARG_LABELS}")
  endif()
  gtest_discover_tests(${name} NO_PRETTY_VALUES TEST_PREFIX "${name}/" DISCOVERY_TIMEOUT 60
                       PROPERTIES ${properties})
endfunction()
