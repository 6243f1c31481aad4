# SPDX-FileCopyrightText: 2026 the keepout authors
# SPDX-License-Identifier: BSD-3-Clause

if(KEEPOUT_WITH_CCD)
  find_package(ccd QUIET)
endif()
keepout_optional(CCD libccd-dev ccd_FOUND "narrow phase of libccd")
if(KEEPOUT_HAS_CCD)
  target_sources(keepout_adapters PRIVATE ccd/narrow_phase.cpp)
  target_link_libraries(keepout_adapters PRIVATE ccd)
  target_compile_definitions(keepout_adapters PRIVATE KEEPOUT_HAS_CCD=1)
  set_property(SOURCE ccd/narrow_phase.cpp
    APPEND PROPERTY COMPILE_DEFINITIONS "KEEPOUT_CCD_VERSION=\"${ccd_VERSION}\"")
endif()
