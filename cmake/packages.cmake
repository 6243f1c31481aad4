# SPDX-License-Identifier: BSD-3-Clause
#
# The Debian packages, by CPack: `cmake --build --preset package` puts them into
# build/release/packages. They link objects that were compiled already: see install.cmake.

set(library libkeepout${KEEPOUT_SOVERSION})
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME keepout)
set(CPACK_PACKAGE_VENDOR "the keepout authors")
set(CPACK_PACKAGE_CONTACT "the keepout authors <keepout@localhost>")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL libkeepout libkeepout-dev keepout-modules)
if(KEEPOUT_BUILD_APPS)
  list(APPEND CPACK_COMPONENTS_ALL keepout keepout-bench)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(full_version ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})

set(about "keepout keeps the tip of a robot's tool out of a triangle mesh: each control cycle it\nreturns the motion nearest to the one asked for that keeps its distance.")
set(CPACK_COMPONENT_LIBKEEPOUT_DESCRIPTION "${about}\nThis package holds the shared libraries.")
set(CPACK_DEBIAN_LIBKEEPOUT_PACKAGE_NAME ${library})
set(CPACK_DEBIAN_LIBKEEPOUT_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBKEEPOUT_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/packaged)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY =)

set(CPACK_COMPONENT_LIBKEEPOUT-DEV_DESCRIPTION "${about}\nThis package holds the headers, and the files of CMake and pkg-config.")
set(CPACK_DEBIAN_LIBKEEPOUT-DEV_PACKAGE_NAME libkeepout-dev)
set(CPACK_DEBIAN_LIBKEEPOUT-DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBKEEPOUT-DEV_PACKAGE_DEPENDS "${library} (= ${full_version}), libeigen3-dev (>= 3.4)")

set(CPACK_DEBIAN_LIBKEEPOUT_PACKAGE_SUGGESTS keepout-modules)

set(CPACK_COMPONENT_KEEPOUT-MODULES_DESCRIPTION "${about}\nThis package holds the modules of other libraries: the indices of FCL, Bullet and Embree,\nthe narrow phases of FCL and libccd, and the solvers of NLopt.")
set(CPACK_DEBIAN_KEEPOUT-MODULES_PACKAGE_NAME keepout-modules)
set(CPACK_DEBIAN_KEEPOUT-MODULES_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_KEEPOUT-MODULES_PACKAGE_SHLIBDEPS ON)

set(CPACK_COMPONENT_KEEPOUT-BENCH_DESCRIPTION "${about}\nThis package holds keepout-bench, which times and compares indices, solvers and planners.")
set(CPACK_DEBIAN_KEEPOUT-BENCH_PACKAGE_NAME keepout-bench)
set(CPACK_DEBIAN_KEEPOUT-BENCH_PACKAGE_SECTION science)
set(CPACK_DEBIAN_KEEPOUT-BENCH_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_KEEPOUT-BENCH_PACKAGE_DEPENDS "keepout (= ${full_version})")
set(CPACK_DEBIAN_KEEPOUT-BENCH_PACKAGE_RECOMMENDS keepout-modules)

set(CPACK_COMPONENT_KEEPOUT_DESCRIPTION "${about}\nThis package holds the command, which needs no other.")
set(CPACK_DEBIAN_KEEPOUT_PACKAGE_NAME keepout)
set(CPACK_DEBIAN_KEEPOUT_PACKAGE_SECTION science)
set(CPACK_DEBIAN_KEEPOUT_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_KEEPOUT_PACKAGE_SUGGESTS "keepout-bench, keepout-modules")
if(BUILD_SHARED_LIBS)
  set(CPACK_DEBIAN_KEEPOUT_PACKAGE_DEPENDS "${library} (= ${full_version})")
endif()

foreach(transport ros1 dds)
  if(TARGET keepout_${transport}_node)
    string(TOUPPER ${transport} name)
    set(node keepout-${transport}-node)
    list(APPEND CPACK_COMPONENTS_ALL ${node})
    set(CPACK_COMPONENT_KEEPOUT-${name}-NODE_DESCRIPTION "${about}\nThis package holds ${node}, a process between a teleoperation and a robot that follow CRTK.")
    set(CPACK_DEBIAN_KEEPOUT-${name}-NODE_PACKAGE_NAME ${node})
    set(CPACK_DEBIAN_KEEPOUT-${name}-NODE_PACKAGE_SECTION science)
    set(CPACK_DEBIAN_KEEPOUT-${name}-NODE_PACKAGE_SHLIBDEPS ON)
    set(CPACK_DEBIAN_KEEPOUT-${name}-NODE_PACKAGE_SUGGESTS keepout)
  endif()
endforeach()

# Debian's policy requires both files in every package.
find_program(KEEPOUT_GZIP gzip REQUIRED)
mark_as_advanced(KEEPOUT_GZIP)
configure_file(${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_BINARY_DIR}/packaged/changelog COPYONLY)
execute_process(COMMAND ${KEEPOUT_GZIP} -9nf ${PROJECT_BINARY_DIR}/packaged/changelog
                COMMAND_ERROR_IS_FATAL ANY)
set(package_libkeepout ${library})
set(package_libkeepout-dev libkeepout-dev)
foreach(component keepout keepout-bench keepout-modules keepout-ros1-node keepout-dds-node)
  set(package_${component} ${component})
endforeach()
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/debian_copyright DESTINATION share/doc/${package_${component}}
          RENAME copyright COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES ${PROJECT_BINARY_DIR}/packaged/changelog.gz DESTINATION share/doc/${package_${component}}
          COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()

include(CPack)

get_property(packaged GLOBAL PROPERTY KEEPOUT_PACKAGED_TARGETS)
add_custom_target(packages
  COMMAND ${CMAKE_CPACK_COMMAND} --config ${PROJECT_BINARY_DIR}/CPackConfig.cmake
  DEPENDS ${packaged}
  WORKING_DIRECTORY ${PROJECT_BINARY_DIR} VERBATIM USES_TERMINAL)
if(TARGET keepout_manual)
  add_dependencies(packages keepout_manual)
endif()
