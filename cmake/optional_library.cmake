# SPDX-License-Identifier: BSD-3-Clause
#
# Optional libraries: without one of them its parts are omitted, with a message.

option(KEEPOUT_WITH_ASSIMP "Time assimp beside our readers: keepout bench --speed" ON)
option(KEEPOUT_WITH_FCL "Indices and narrow phase of FCL" ON)
option(KEEPOUT_WITH_BULLET "Indices of Bullet" ON)
option(KEEPOUT_WITH_EMBREE "Index of Embree" ON)
option(KEEPOUT_WITH_CCD "Narrow phase of libccd" ON)
option(KEEPOUT_WITH_NLOPT "Solvers of NLopt" ON)
option(KEEPOUT_WITH_OMPL "Validators and a planner for OMPL" ON)
option(KEEPOUT_WITH_URDF "Reader of robots in URDF" ON)
option(KEEPOUT_WITH_MUJOCO "Simulate masses and servos of a robot: keepout simulate --physics" ON)
option(KEEPOUT_WITH_ROS1 "Node for ROS 1: keepout-ros1-node" ON)
option(KEEPOUT_WITH_DDS "Node for DDS, as of ROS 2: keepout-dds-node" ON)
# GPL-3: programs that link it may be distributed only under the GPL. Never in the library.
option(KEEPOUT_WITH_CGAL "Index of CGAL, for tests and benchmarks" OFF)

# keepout_optional(NAME PACKAGE FOUND BRINGS): sets KEEPOUT_HAS_NAME to true if the library is
# enabled and was found. Otherwise prints the missing parts. Call it after find_package or
# find_library.
function(keepout_optional name package found brings)
  set(has OFF)
  if(KEEPOUT_WITH_${name} AND ${found})
    set(has ON)
  elseif(KEEPOUT_WITH_${name})
    message(WARNING "keepout: ${name} was not found, so there is no ${brings}. Install ${package}; "
                    "or set KEEPOUT_WITH_${name}=OFF to go without it.")
  else()
    message(STATUS "keepout: without ${name} there is no ${brings} (KEEPOUT_WITH_${name} is OFF)")
  endif()
  set(KEEPOUT_HAS_${name} ${has} PARENT_SCOPE)
endfunction()

# keepout_module(NAME SOURCES... [NOT_INSTALLED] LINKS LIBRARIES...): makes the shared object with
# the parts of another library. Only this object links that library: see
# engine/include/keepout/module.h. The target keepout_modules builds all modules.
add_custom_target(keepout_modules)
function(keepout_module name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "NOT_INSTALLED" "" "LINKS")
  set(target keepout_module_${name})
  add_library(${target} MODULE ${arg_UNPARSED_ARGUMENTS} ${PROJECT_SOURCE_DIR}/adapters/src/module_version.cpp)
  target_link_libraries(${target} PRIVATE ${arg_LINKS})
  target_link_options(${target} PRIVATE LINKER:--exclude-libs,ALL)
  keepout_compile_options(${target})
  set_target_properties(${target} PROPERTIES
    PREFIX "" OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/keepout-modules
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  add_dependencies(keepout_modules ${target})
  if(KEEPOUT_INSTALL AND NOT arg_NOT_INSTALLED)
    install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/keepout-modules
            COMPONENT keepout_runtime)
    set_property(GLOBAL APPEND PROPERTY KEEPOUT_INSTALLED_TARGETS ${target})
    install(TARGETS ${target} LIBRARY DESTINATION keepout/keepout-modules COMPONENT python EXCLUDE_FROM_ALL)
    if(KEEPOUT_PACKAGES)
      install(TARGETS ${target} LIBRARY DESTINATION ${KEEPOUT_PACKAGE_LIBDIR}/keepout-modules
              COMPONENT keepout-modules EXCLUDE_FROM_ALL)
      set_property(GLOBAL APPEND PROPERTY KEEPOUT_PACKAGED_TARGETS ${target})
    endif()
  endif()
endfunction()
