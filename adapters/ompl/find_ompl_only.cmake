# SPDX-License-Identifier: BSD-3-Clause
#
# Makes the target ompl_only from the results of find_package(ompl): here, and for users of the
# installed keepout::ompl. The package's own list of libraries includes some that are not needed.

find_library(KEEPOUT_OMPL_LIBRARY NAMES ompl HINTS ${OMPL_LIBRARY_DIRS})
mark_as_advanced(KEEPOUT_OMPL_LIBRARY)
if(NOT KEEPOUT_OMPL_LIBRARY)
  list(APPEND _keepout_missing "libompl was not found: install libompl-dev")
elseif(NOT TARGET ompl_only)
  add_library(ompl_only INTERFACE IMPORTED GLOBAL)
  target_include_directories(ompl_only INTERFACE ${OMPL_INCLUDE_DIR})
  target_link_libraries(ompl_only INTERFACE ${KEEPOUT_OMPL_LIBRARY})
endif()
