# SPDX-License-Identifier: BSD-3-Clause
#
# The contents of `cmake --install` and of the Debian packages.
#
# keepout_install(TARGET COMPONENT [NOT_PACKAGED] [PUBLIC_PACKAGES ...] [PRIVATE_PACKAGES ...]
#                 [FIND_SCRIPT file])
#   installs a library of keepout, exported as keepout::COMPONENT for find_package(keepout COMPONENTS
#   COMPONENT) and as keepout-COMPONENT.pc, with its headers. Call it last in a folder's
#   CMakeLists.txt. Its linked libraries give its dependencies. Its headers are all files in its
#   public include directories.
#
#   PUBLIC_PACKAGES:  packages that a consumer needs, as "EIGEN@DEBIAN@PC": arguments of find_package,
#                     the Debian package, the module of pkg-config.
#
#   PRIVATE_PACKAGES: packages that a consumer needs only if the library is static, as
#                     "FCL@DEBIAN@FLAGS": the arguments of find_package, or "-lNAME"; the Debian
#                     package; the linker's flags.
#
#   FIND_SCRIPT:      a consumer includes it before the target. It makes targets of other libraries
#                     that no package makes. If it fails, it appends advice to _keepout_missing.
#
#   NOT_PACKAGED:     not in the Debian packages.
#
# keepout_install_config() installs keepout-config.cmake for all of them; call it once, after them.

include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

option(KEEPOUT_INSTALL "Install keepout with the project that embeds it" ${PROJECT_IS_TOP_LEVEL})
set(KEEPOUT_PACKAGES_DEFAULT OFF)
find_program(KEEPOUT_SHLIBDEPS dpkg-shlibdeps)
mark_as_advanced(KEEPOUT_SHLIBDEPS)
if(PROJECT_IS_TOP_LEVEL AND CMAKE_BUILD_TYPE STREQUAL "Release" AND KEEPOUT_SHLIBDEPS AND NOT KEEPOUT_SANITIZE)
  set(KEEPOUT_PACKAGES_DEFAULT ON)
endif()
option(KEEPOUT_PACKAGES "Link what the Debian packages hold; target `packages` makes them"
       ${KEEPOUT_PACKAGES_DEFAULT})

# Before 1.0 a minor version may break compatibility. The symbols contain the version, so the loader
# rejects a program that was built with another one.
set(KEEPOUT_SOVERSION ${PROJECT_VERSION_MAJOR})
set(KEEPOUT_SYMBOLS ${PROJECT_BINARY_DIR}/exported_symbols.map)
configure_file(${PROJECT_SOURCE_DIR}/cmake/exported_symbols.map.in ${KEEPOUT_SYMBOLS} @ONLY)

# The folder of libraries in Debian packages.
set(KEEPOUT_PACKAGE_LIBDIR lib)
if(CMAKE_LIBRARY_ARCHITECTURE)
  set(KEEPOUT_PACKAGE_LIBDIR lib/${CMAKE_LIBRARY_ARCHITECTURE})
endif()

function(keepout_shared_library target)
  set_target_properties(${target} PROPERTIES
    VERSION ${PROJECT_VERSION} SOVERSION ${KEEPOUT_SOVERSION} LINK_DEPENDS ${KEEPOUT_SYMBOLS})
  target_link_options(${target} PRIVATE
    -Wl,--version-script=${KEEPOUT_SYMBOLS} -Wl,-Bsymbolic-functions)
  if(NOT KEEPOUT_SANITIZE)
    target_link_options(${target} PRIVATE -Wl,-z,defs)
  endif()
endfunction()

# Makes the shared form of a static library, from the same position-independent objects. So packages
# need another link, but no build.
function(keepout_packaged_library target)
  set(twin ${target}_packaged)
  get_target_property(type ${target} TYPE)
  if(type STREQUAL "INTERFACE_LIBRARY")
    add_library(${twin} INTERFACE)
    set(properties INTERFACE_INCLUDE_DIRECTORIES INTERFACE_COMPILE_FEATURES INTERFACE_LINK_LIBRARIES)
  else()
    add_library(${twin} SHARED $<TARGET_OBJECTS:${target}>)
    set_target_properties(${twin} PROPERTIES
      LINKER_LANGUAGE CXX LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/packaged)
    keepout_shared_library(${twin})
    set(properties INTERFACE_INCLUDE_DIRECTORIES INTERFACE_COMPILE_FEATURES INTERFACE_LINK_LIBRARIES
                   LINK_LIBRARIES)
  endif()
  foreach(property IN LISTS properties)
    get_target_property(value ${target} ${property})
    if(NOT value)
      continue()
    endif()
    if(property STREQUAL "INTERFACE_LINK_LIBRARIES")
      list(FILTER value EXCLUDE REGEX "LINK_ONLY")
    endif()
    set(packaged)
    foreach(item IN LISTS value)
      if(item MATCHES "^keepout::" AND property MATCHES "LINK_LIBRARIES")
        get_target_property(ours ${item} ALIASED_TARGET)
        set(item ${ours}_packaged)
      endif()
      list(APPEND packaged "${item}")
    endforeach()
    set_property(TARGET ${twin} PROPERTY ${property} "${packaged}")
  endforeach()
endfunction()

# Writes the pkg-config file of a component. `form`: linked (as the libraries were built) or
# packaged.
function(keepout_pkg_config component form libdir name requires link private file)
  set(KEEPOUT_PC_COMPONENT ${component})
  string(JOIN " " KEEPOUT_PC_REQUIRES ${requires})
  set(KEEPOUT_PC_LIBS "${link}")
  string(JOIN " " KEEPOUT_PC_LIBS_PRIVATE ${private})
  set(KEEPOUT_PC_LIBDIR ${libdir})
  # The path from the file to the prefix, so that the installation can be moved.
  file(RELATIVE_PATH KEEPOUT_PC_PREFIX /prefix/${libdir}/pkgconfig /prefix)
  string(REGEX REPLACE "/$" "" KEEPOUT_PC_PREFIX ${KEEPOUT_PC_PREFIX})
  set(path ${PROJECT_BINARY_DIR}/${form}/${name}.pc)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/keepout.pc.in ${path} @ONLY)
  set(${file} ${path} PARENT_SCOPE)
endfunction()

function(keepout_install target component)
  cmake_parse_arguments(PARSE_ARGV 2 arg "NOT_PACKAGED" "FIND_SCRIPT" "PUBLIC_PACKAGES;PRIVATE_PACKAGES")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "keepout_install(${target}): what is ${arg_UNPARSED_ARGUMENTS}?")
  endif()
  set(output keepout_${component})
  if(component STREQUAL "keepout")
    set(output keepout)
  endif()
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${component})
  get_target_property(type ${target} TYPE)
  if(NOT type STREQUAL "INTERFACE_LIBRARY")
    set_target_properties(${target} PROPERTIES OUTPUT_NAME ${output})
  endif()
  if(type STREQUAL "SHARED_LIBRARY")
    keepout_shared_library(${target})
    set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN")
  endif()
  # Paths of this machine are not installed.
  get_target_property(headers ${target} INTERFACE_INCLUDE_DIRECTORIES)
  list(JOIN headers "$<SEMICOLON>" directories)
  set_target_properties(${target} PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "$<BUILD_INTERFACE:${directories}>")
  if(NOT KEEPOUT_INSTALL)
    return()
  endif()

  set(needs)
  foreach(property LINK_LIBRARIES INTERFACE_LINK_LIBRARIES)
    get_target_property(value ${target} ${property})
    foreach(item IN LISTS value)
      if(item MATCHES "^keepout::([a-z_]+)$")
        list(APPEND needs ${CMAKE_MATCH_1})
      endif()
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES needs)
  set(requires)
  foreach(entry IN LISTS arg_PUBLIC_PACKAGES)
    string(REPLACE "@" ";" entry "${entry}")
    list(GET entry 2 module)
    list(APPEND requires ${module})
  endforeach()
  foreach(need IN LISTS needs)
    list(APPEND requires keepout-${need})
  endforeach()
  set(private)
  foreach(entry IN LISTS arg_PRIVATE_PACKAGES)
    string(REPLACE "@" ";" entry "${entry}")
    list(GET entry 2 flags)
    list(APPEND private ${flags})
  endforeach()
  set(link "-L\${libdir} -l${output}")
  if(type STREQUAL "INTERFACE_LIBRARY")
    set(link)
  endif()
  set(name keepout-${component})
  if(component STREQUAL "keepout")
    set(name keepout)
  endif()

  # The form as built.
  set(private_packages ${arg_PRIVATE_PACKAGES})
  if(NOT type STREQUAL "STATIC_LIBRARY")
    set(private_packages)
  endif()
  set_property(GLOBAL APPEND PROPERTY KEEPOUT_linked_COMPONENTS ${component})
  set_property(GLOBAL PROPERTY KEEPOUT_linked_${component}
    "set(_keepout_${component}_needs ${needs})\nset(_keepout_${component}_packages \"${arg_PUBLIC_PACKAGES};${private_packages}\")\n")
  if(NOT type STREQUAL "INTERFACE_LIBRARY")
    set_property(GLOBAL APPEND PROPERTY KEEPOUT_INSTALLED_TARGETS ${target})
  endif()
  install(TARGETS ${target} EXPORT keepout-${component}
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT keepout_runtime
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT keepout_runtime
            NAMELINK_COMPONENT keepout_development
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT keepout_development
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT keepout-${component} NAMESPACE keepout::
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/keepout COMPONENT keepout_development)
  foreach(directory IN LISTS headers)
    install(DIRECTORY ${directory}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
            COMPONENT keepout_development FILES_MATCHING PATTERN "*.h")
  endforeach()
  keepout_pkg_config(${component} linked ${CMAKE_INSTALL_LIBDIR} ${name} "${requires}" "${link}"
                     "${private}" file)
  install(FILES ${file} DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT keepout_development)
  if(arg_FIND_SCRIPT)
    install(FILES ${arg_FIND_SCRIPT} DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/keepout
            RENAME keepout-${component}-find.cmake COMPONENT keepout_development)
  endif()

  # The packaged form.
  if(NOT KEEPOUT_PACKAGES OR arg_NOT_PACKAGED)
    return()
  endif()
  keepout_packaged_library(${target})
  set_target_properties(${target}_packaged PROPERTIES EXPORT_NAME ${component})
  if(NOT type STREQUAL "INTERFACE_LIBRARY")
    set_target_properties(${target}_packaged PROPERTIES OUTPUT_NAME ${output})
    set_property(GLOBAL APPEND PROPERTY KEEPOUT_PACKAGED_TARGETS ${target}_packaged)
  endif()
  set_property(GLOBAL APPEND PROPERTY KEEPOUT_packaged_COMPONENTS ${component})
  set_property(GLOBAL PROPERTY KEEPOUT_packaged_${component}
    "set(_keepout_${component}_needs ${needs})\nset(_keepout_${component}_packages \"${arg_PUBLIC_PACKAGES}\")\n")
  install(TARGETS ${target}_packaged EXPORT keepout-packaged-${component}
    LIBRARY DESTINATION ${KEEPOUT_PACKAGE_LIBDIR} COMPONENT libkeepout NAMELINK_COMPONENT libkeepout-dev
            EXCLUDE_FROM_ALL
    INCLUDES DESTINATION include)
  install(EXPORT keepout-packaged-${component} NAMESPACE keepout:: FILE keepout-${component}.cmake
    DESTINATION ${KEEPOUT_PACKAGE_LIBDIR}/cmake/keepout COMPONENT libkeepout-dev EXCLUDE_FROM_ALL)
  foreach(directory IN LISTS headers)
    install(DIRECTORY ${directory}/ DESTINATION include
            COMPONENT libkeepout-dev EXCLUDE_FROM_ALL FILES_MATCHING PATTERN "*.h")
  endforeach()
  keepout_pkg_config(${component} packaged ${KEEPOUT_PACKAGE_LIBDIR} ${name} "${requires}" "${link}" ""
                     file)
  install(FILES ${file} DESTINATION ${KEEPOUT_PACKAGE_LIBDIR}/pkgconfig COMPONENT libkeepout-dev
    EXCLUDE_FROM_ALL)
  if(arg_FIND_SCRIPT)
    install(FILES ${arg_FIND_SCRIPT} DESTINATION ${KEEPOUT_PACKAGE_LIBDIR}/cmake/keepout
            RENAME keepout-${component}-find.cmake COMPONENT libkeepout-dev EXCLUDE_FROM_ALL)
  endif()
endfunction()

# Writes the table of a form's components for keepout-config.cmake, each after its dependencies.
function(keepout_write_config form version_file config_file)
  get_property(KEEPOUT_CONFIG_COMPONENTS GLOBAL PROPERTY KEEPOUT_${form}_COMPONENTS)
  set(KEEPOUT_CONFIG_TABLE)
  foreach(component IN LISTS KEEPOUT_CONFIG_COMPONENTS)
    get_property(rows GLOBAL PROPERTY KEEPOUT_${form}_${component})
    string(APPEND KEEPOUT_CONFIG_TABLE "${rows}")
  endforeach()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/keepout-config.cmake.in
                 ${PROJECT_BINARY_DIR}/${form}/keepout-config.cmake @ONLY)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/${form}/keepout-config-version.cmake
    VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)
  set(${config_file} ${PROJECT_BINARY_DIR}/${form}/keepout-config.cmake PARENT_SCOPE)
  set(${version_file} ${PROJECT_BINARY_DIR}/${form}/keepout-config-version.cmake PARENT_SCOPE)
endfunction()

function(keepout_install_config)
  if(NOT KEEPOUT_INSTALL)
    return()
  endif()
  keepout_write_config(linked version config)
  install(FILES ${version} ${config} DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/keepout
          COMPONENT keepout_development)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/third_party_notes.md
          DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT keepout_development)
  if(KEEPOUT_PACKAGES)
    keepout_write_config(packaged version config)
    install(FILES ${version} ${config} DESTINATION ${KEEPOUT_PACKAGE_LIBDIR}/cmake/keepout
            COMPONENT libkeepout-dev EXCLUDE_FROM_ALL)
    include(${PROJECT_SOURCE_DIR}/cmake/packages.cmake)
  endif()
endfunction()
