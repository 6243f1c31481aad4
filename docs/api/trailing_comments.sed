# SPDX-License-Identifier: BSD-3-Clause
#
# What doxygen reads in place of a header: a comment that follows a member on its line belongs to it,
# so that headers need no `///<`.
s#^([[:space:]]*[^/[:space:]][^/]*[;,A-Za-z0-9_)}])[[:space:]]+// #\1  ///< #
