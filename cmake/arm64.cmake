# SPDX-License-Identifier: BSD-3-Clause
#
# keepout for Linux on arm64, by Debian's cross compiler: g++-aarch64-linux-gnu, and the arm64 packages
# of the libraries. Tests and examples run by QEMU: qemu-user-static. See docs/embedding.md.

set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static)
# Debian's cross compiler searches the arm64 folders of the system, so no other root is needed.
set(ENV{PKG_CONFIG_LIBDIR} /usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig)
set(CMAKE_SKIP_RPATH ON)  # the folder of the arm64 libraries is among those that the loader searches
