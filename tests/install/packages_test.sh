#!/usr/bin/env bash
# Unpacks the Debian packages. They hold what they should, and nothing that may not be redistributed.
#   packages_test.sh WORK SOURCE
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/common.sh"
work=$1 source=$2

rm -rf "$work/unpacked"
count=0
for package in "$work"/packages/*.deb; do
  dpkg -x "$package" "$work/unpacked"
  name=$(dpkg -f "$package" Package)
  for file in copyright changelog.gz; do
    [ -s "$work/unpacked/usr/share/doc/$name/$file" ] || fail "$name has no $file"
  done
  count=$((count + 1))
done
nodes=$(find "$work/packages" -maxdepth 1 -name 'keepout-*-node_*.deb' | wc -l)  # of transports that were found
[ $((count - nodes)) -eq 5 ] || fail "$count packages, $nodes of them nodes, instead of 5 and nodes"
# Debian's policy and bash expect these files, under the names of the programs.
for package in keepout keepout-bench; do
  held=$(dpkg -c "$work/packages/${package}"_*.deb)
  for file in "man/man1/$package.1.gz" "bash-completion/completions/$package"; do
    grep -q " ./usr/share/$file$" <<< "$held" || fail "$package has no $file"
  done
done

cd "$work/unpacked"
for forbidden in cgal gpl real_mesh oracle; do
  found=$(find . -iname "*$forbidden*")
  [ -z "$found" ] || fail "not to be passed on: $found"
done
found=$(grep -rlF "$source" . || true)
[ -z "$found" ] || fail "a path of this machine is in: $found"

usr/bin/keepout --version
usr/bin/keepout inspect "$here/cube.obj" | grep -q watertight || fail "the command cannot inspect"
! usr/bin/keepout bench --help | grep -q '^ *cgal' || fail "the command has CGAL"

# Programs and libraries for users must not need the libraries of modules and comparisons, and must not
# replace functions of the system.
for file in usr/bin/keepout usr/lib/*/*.so.*; do
  needed=$(readelf -d "$file" | grep NEEDED | grep -iE 'fcl|ccd|bullet|linearmath|embree|nlopt|ompl|assimp' || true)
  [ -z "$needed" ] || fail "$file needs: $needed"
  replaced=$(nm -D --defined-only "$file" | grep -E ' [TW] (malloc|calloc|realloc|free|pthread_)' || true)
  [ -z "$replaced" ] || fail "$file replaces: $replaced"
done
printf '0 0 12 1 0 -4\n' > poses.txt
for index in fcl_obbrss bullet embree; do
  usr/bin/keepout replay "$here/cube.obj" --poses poses.txt --out steps.csv --index $index ||
    fail "the command does not find the module of $index"
  ! KEEPOUT_MODULES=/nowhere usr/bin/keepout replay "$here/cube.obj" --poses poses.txt --out steps.csv \
    --index $index > said 2>&1 || fail "there is $index without its module"
  grep -q "install keepout-modules" said || fail "without the module of $index it says: $(cat said)"
done

for library in usr/lib/*/*.so.*; do
  # A library exports only symbols of keepout: no template of another library may replace a program's own.
  foreign=$(nm -DC --defined-only "$library" | grep -v -e ' keepout::' -e ' A KEEPOUT_' \
    -e ' \(vtable\|typeinfo\|typeinfo name\|VTT\|guard variable\) for keepout::' || true)
  [ -z "$foreign" ] || fail "$library shows: $foreign"
  ! readelf -d "$library" | grep -q -e RUNPATH -e RPATH || fail "$library has a path to libraries"
done
