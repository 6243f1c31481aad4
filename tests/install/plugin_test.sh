#!/usr/bin/env bash
# Builds a plugin outside of the tree, against an installed keepout. Tests that it passes the contracts of
# keepout::testing, that the commands use it, and that they reject wrong files.
#   plugin_test.sh PREFIX WORK EXAMPLES
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/common.sh"
prefix=$1 work=$2 examples=$3
libraries=$(library_folder "$prefix")
export LD_LIBRARY_PATH=$libraries

cmake -S "$examples/plugin" -B "$work/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release \
  --no-warn-unused-cli
cmake --build "$work/build" -j2
"$work/build/contract_test" --gtest_brief=1

cd "$work"
bench=$prefix/bin/keepout
plugin=build/my_parts.so
"$bench" bench --plugin $plugin --mesh cube --index my_grid,wide_bvh --solver active_set,hildreth --activation certified \
  --queries 200 --seconds 0.2 --out bench.html | tee bench.txt
grep -q my_grid bench.txt || fail "bench does not measure the plugin"
! grep -q 'not timed' bench.txt || fail "bench rejects the plugin"
"$bench" compare star_bumps --plugin $plugin --poses 12 --problems 200 --pairs 10 --out compare.html > compare.txt ||
  { cat compare.txt; fail "compare finds the plugin wrong"; }
grep -q my_grid compare.txt && grep -q hildreth compare.txt || fail "compare omits the plugin: $(cat compare.txt)"
"$bench" verify cube --plugin $plugin --index my_grid --steps 200 --out verify.html > /dev/null

# Wrong files, and wrong names.
rejected() {
  local expected=$1
  shift
  ! "$bench" bench "$@" > said.txt 2>&1 || fail "accepted: $*"
  grep -qF -e "$expected" said.txt || fail "expected '$expected' from '$*': $(cat said.txt)"
}
printf 'int main;\n' > plain.c
cc -shared -o plain.so plain.c
printf 'const char keepout_module_version[] = "0.0.1";\n' > other.c
cc -shared -o other.so other.c
version=$("$bench" --version)
printf 'const char keepout_module_version[] = "%s";\n' "${version##* }" > empty.c
cc -shared -o empty.so empty.c
rejected "there is no file nowhere.so" --plugin nowhere.so
rejected "invalid ELF header" --plugin bench.txt
rejected "no version of keepout" --plugin plain.so
rejected "keepout 0.0.1" --plugin other.so
rejected "exports no parts" --plugin empty.so
rejected "has the index 'my_grid', and another part has that name" --plugin $plugin,$plugin
rejected "did you mean 'my_grid'" --plugin $plugin --index my_gird
