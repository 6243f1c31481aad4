# SPDX-License-Identifier: BSD-3-Clause
#
# Included when `pages`, a folder of documentation, has been installed: links to what is not installed, such as
# sources, become their words.
cmake_path(ABSOLUTE_PATH pages BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}" NORMALIZE)
file(GLOB_RECURSE files "$ENV{DESTDIR}${pages}/*.md")
foreach(file IN LISTS files)
  cmake_path(GET file PARENT_PATH folder)
  file(READ "${file}" text)
  set(rest "${text}")
  # A target has a dot or a slash, which the parameters of a lambda have not.
  while(rest MATCHES "\\[([^]]*)\\]\\(([A-Za-z0-9_-]*[./][A-Za-z0-9_./-]*)(#[^()]*)?\\)")
    set(link "${CMAKE_MATCH_0}")
    set(words "${CMAKE_MATCH_1}")
    if(NOT EXISTS "${folder}/${CMAKE_MATCH_2}")
      string(REPLACE "${link}" "${words}" text "${text}")
    endif()
    string(FIND "${rest}" "${link}" begin)
    string(LENGTH "${link}" length)
    math(EXPR begin "${begin} + ${length}")
    string(SUBSTRING "${rest}" ${begin} -1 rest)
  endwhile()
  file(WRITE "${file}" "${text}")
endforeach()
