# SPDX-License-Identifier: BSD-3-Clause
#
# Cross-compiles for arm64 on Debian, and runs what is built under QEMU. Once:
#
#   dpkg --add-architecture arm64 && apt-get update
#   apt-get install g++-aarch64-linux-gnu qemu-user-static libhwy-dev:arm64 libxxhash-dev:arm64
#                   libexpat1-dev:arm64 zlib1g-dev:arm64
#   cmake --preset arm64 && cmake --build --preset arm64
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static)
# The loader of arm64 finds its libraries without a path; a path of this machine would name those of x86.
set(CMAKE_SKIP_RPATH ON)
