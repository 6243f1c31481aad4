# SPDX-License-Identifier: BSD-3-Clause
#
# The filter for headers: a comment that follows a member on its line documents it, so headers need no `///<`.
s#^([[:space:]]*[^/[:space:]][^/]*[;,A-Za-z0-9_)}])[[:space:]]+// #\1  ///< #
