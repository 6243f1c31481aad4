# SPDX-FileCopyrightText: 2026 the keepout authors
# SPDX-License-Identifier: BSD-3-Clause

if(NOT DEFINED KEEPOUT_HAS_FCL)
  if(KEEPOUT_WITH_FCL)
    find_package(fcl QUIET)
  endif()
  keepout_optional(FCL libfcl-dev fcl_FOUND "narrow phase of FCL")
endif()
if(KEEPOUT_HAS_FCL)
  target_sources(keepout_adapters PRIVATE fcl/narrow_phase.cpp)
  target_link_libraries(keepout_adapters PRIVATE fcl)
  target_compile_definitions(keepout_adapters PRIVATE KEEPOUT_HAS_FCL=1)
  # The alignment that the library was built with, whatever vectors this machine has.
  set_property(SOURCE fcl/narrow_phase.cpp
    APPEND PROPERTY COMPILE_DEFINITIONS EIGEN_MAX_ALIGN_BYTES=16)
endif()
