# Waymark's core for programs outside its tree: Waymark::map, Waymark::estimate, Waymark::detect and what they need.
include(${CMAKE_CURRENT_LIST_DIR}/core_dependencies.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/WaymarkTargets.cmake)
