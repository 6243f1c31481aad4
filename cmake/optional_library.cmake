# SPDX-License-Identifier: BSD-3-Clause
#
# Libraries that keepout does without: what they bring is left out, and said to be.

option(KEEPOUT_WITH_ASSIMP "Time assimp beside our readers: keepout bench --speed" ON)
option(KEEPOUT_WITH_FCL "Indices and narrow phase of FCL" ON)
option(KEEPOUT_WITH_BULLET "Indices of Bullet" ON)
option(KEEPOUT_WITH_EMBREE "Index of Embree" ON)
option(KEEPOUT_WITH_CCD "Narrow phase of libccd" ON)
option(KEEPOUT_WITH_NLOPT "Solvers of NLopt" ON)
option(KEEPOUT_WITH_OMPL "Validators and a planner for OMPL" ON)
option(KEEPOUT_WITH_URDF "Reader of robots in URDF" ON)
# GPL-3: what is linked with it may only be passed on under the GPL. Never in the library.
option(KEEPOUT_WITH_CGAL "Index of CGAL, for tests and benchmarks" OFF)

# keepout_optional(NAME PACKAGE FOUND BRINGS): sets KEEPOUT_HAS_NAME to whether the library is wanted
# and was found, and says what is missing without it. Call it after looking for the library.
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
