# The parts of the tests. Each is a function part_NAME with a title in the comment above it. ./test runs `release` and
# `asan` at short length. `./test --long` runs all parts in this order, and writes a page (tests/nightly). A part ends
# with status 77 if the machine or the tree lacks what it needs. The page shows each line `figure: ...` that it prints.
# SPDX-License-Identifier: BSD-3-Clause
#
# Set before: root, length (short or long), minutes (for each part without an end of its own), results (a directory
# for the part's files).

skip() { printf 'skipped: %s\n' "$*"; exit 77; }
need() {
  local program
  for program in "$@"; do
    [ -e "$program" ] || command -v "$program" >/dev/null || skip "$program is missing"
  done
}

# require_options_of_ctest OPTION...: ctest ignores an option that it does not know.
require_options_of_ctest() {
  local option
  for option in "$@"; do
    [[ $option != --* ]] || [[ $(ctest --help) == *" ${option%%=*}"[\ ,=$'\n']* ]] ||
      fail "'$option' is no option of ctest: see ctest --help; --long stands first"
  done
}

# run_ctest PRESET ARGS...: runs tests, and prints those that were skipped.
run_ctest() {
  local preset=$1 status=0
  shift
  # One job more than processors, because some tests wait.
  (cd "$root" && ctest --preset "$preset" -j "$(($(nproc) + 1))" "$@") || status=$?
  # A program passes if its tests pass or are skipped, so print the skipped tests.
  grep -h '^\[  SKIPPED \] [^ ]*$' "$root/build/$preset/Testing/Temporary/LastTest.log" | sort -u || true
  return $status
}

# run_tests PRESET ARGS...: runs the tests of the requested length; long includes short.
run_tests() {
  if [ "$length" = short ]; then
    # A test that hangs must leave time for the others.
    run_ctest "$@" -L short --timeout 900
  else
    KEEPOUT_ALL_TRIALS=1 run_ctest "$@"
  fi
}

# until_the_end COMMAND...: repeats a command, with a new seed as its last argument, for the minutes of this part. The
# seeds of each day differ, and the log has them.
until_the_end() {
  local seed
  seed=$(date +%Y%m%d)0000
  SECONDS=0
  while [ $SECONDS -lt $((60 * minutes)) ]; do
    seed=$((seed + 1))
    say "seed $seed"
    "$@" "$seed"
  done
}

# count_without_breach UNIT: prints how many steps or cycles the campaigns of this part tested.
count_without_breach() {
  awk -v unit="$1" '/^No breach in / && $5 ~ "^" unit { gsub(",", "", $4); n += $4 }
    END { printf "figure: %d %s without a breach\n", n, unit }' "$results"/campaign.txt
}

# part release: all tests, optimized, and the pages in two browsers
part_release() {
  if [ "$length" = short ]; then
    build release products short_tests
  else
    build release
  fi
  "$root/apps/web/build" tests
  "$root/fixtures/prepare"
  say "testing (release)"
  run_tests release "$@"
}

# part asan: all programs under the address and undefined-behavior sanitizers
part_asan() {
  if [ "$length" = short ]; then
    build asan short_tests
  else
    build asan
  fi
  say "testing (address and undefined-behaviour sanitizers)"
  run_tests asan "$@"
}

# part asan_campaign: attacks on tips, instruments and guides under these sanitizers
part_asan_campaign() {
  build asan keepout
  until_the_end campaign_of_all asan
  count_without_breach steps
  count_without_breach cycles
}

# part tsan: programs with threads, under the thread sanitizer
part_tsan() {
  local programs=(index_contract_test index_test load_mesh_test certified_step_test input_test igtl_test guard_node_test)
  build tsan "${programs[@]}"
  say "testing (thread sanitizer)"
  run_ctest tsan -R "^($(IFS='|'; echo "${programs[*]}"))(_[0-9]+)?\$"
}

# part clang: clang compiles libraries and examples without warnings, and their short C++ tests pass
part_clang() {
  need clang++
  build clang short_tests
  run_ctest clang -L short -L program
}

# part debug: without optimization and with assertions, the short C++ tests
part_debug() {
  build debug short_tests
  run_ctest debug -L short -L program
}

# part bench: each source compiles by itself, without precompiled headers, as in projects without our presets
part_bench() { build bench; }

# part simd: 100,000 steps of each kind are bitwise the same on each SIMD target, also of emulated processors
part_simd() {
  local model output program=$root/build/release/tests/same_steps_test
  build release same_steps_test
  output=$(KEEPOUT_ALL_TRIALS=1 "$program") || { printf '%s\n' "$output"; return 1; }
  printf '%s\n' "$output"
  echo "figure: $(grep -c 'OK .*OfKind' <<< "$output") kinds of step, for $(
    grep -owE 'avx512bw|avx2|sse4_2|ssse3|sse2|asimd' /proc/cpuinfo | sort -u | xargs)"
  [ "$(uname -m)" = x86_64 ] || return 0
  if ! command -v qemu-x86_64-static >/dev/null; then
    echo "figure: emulated processors skipped: qemu-x86_64-static is missing"
    return 0
  fi
  # AVX2, SSE4, SSSE3, SSE2. QEMU emulates no AVX-512.
  for model in Haswell Nehalem core2duo Opteron_G1; do
    say "emulating $model"
    output=$(qemu-x86_64-static -cpu "$model" "$program" 2> >(grep -v "TCG doesn't support" >&2)) ||
      { printf '%s\n' "$output"; return 1; }
    printf '%s\n' "$output"
    echo "figure: $model: $(grep -c 'OK .*OfKind' <<< "$output") kinds, $(grep -c '^\[  SKIPPED.*ms)' <<< "$output") skipped"
  done
}

# part arm64: on an emulated aarch64 with NEON, the short tests of engine and robot, and 100,000 steps of each kind
part_arm64() {
  local output programs=(same_steps_test index_test geometry_test activation_test step_test solver_test robot_test)
  need aarch64-linux-gnu-g++ qemu-aarch64-static /usr/lib/aarch64-linux-gnu/libhwy.so
  build arm64 "${programs[@]}"
  output=$(KEEPOUT_ALL_TRIALS=1 qemu-aarch64-static "$root/build/arm64/tests/same_steps_test") ||
    { printf '%s\n' "$output"; return 1; }
  printf '%s\n' "$output"
  echo "figure: $(grep -c 'OK .*OfKind' <<< "$output") kinds of step with the bits of x86-64"
  run_ctest arm64 -R "^($(IFS='|'; echo "${programs[*]:1}"))(_[0-9]+)?\$"
}

# campaign_of_tips PRESET SEED
campaign_of_tips() {
  "$root/build/$1/apps/keepout/keepout" verify -q --steps 2000000 --seed "$2" --json "$results/tips_$2.json" |
    tee -a "$results/campaign.txt"
}

# campaign_of_instruments PRESET SEED
campaign_of_instruments() {
  local scenario scenarios=()
  for scenario in approach raised overlapping wedged guides blade moving meshes stuck unlimited tip_guides convex_tool; do
    scenarios+=(--scenario "$scenario")
  done
  "$root/build/$1/apps/keepout/keepout" verify -q "${scenarios[@]}" --cycles 5000 --seed "$2" \
    --json "$results/scenarios_$2.json" | tee -a "$results/campaign.txt"
  "$root/build/$1/apps/keepout/keepout" verify -q --robot psm skull airway --cycles 2000 --seed "$2" \
    --json "$results/psm_$2.json" | tee -a "$results/campaign.txt"
}

# campaign_of_all PRESET SEED: few steps of each kind, for slow builds
campaign_of_all() {
  local keepout=$root/build/$1/apps/keepout/keepout
  "$keepout" verify -q cortex gear airway --steps 20000 --seed "$2" | tee -a "$results/campaign.txt"
  "$keepout" verify -q --scenario approach --scenario guides --scenario blade --scenario moving --scenario meshes \
    --scenario tip_guides --scenario convex_tool --cycles 200 --seed "$2" | tee -a "$results/campaign.txt"
}

# part campaign_tips: attacks on the step of a tip, judged by the oracle
part_campaign_tips() {
  build release keepout
  "$root/fixtures/prepare"
  until_the_end campaign_of_tips release
  count_without_breach steps
}

# part campaign_instruments: attacks on the step of an instrument, in all scenarios
part_campaign_instruments() {
  build release keepout
  "$root/fixtures/prepare"
  until_the_end campaign_of_instruments release
  count_without_breach cycles
}

# part fuzzing: readers, protocols and steps with random input (libFuzzer)
part_fuzzing() {
  need clang++-16
  "$root/tests/fuzz/run" --in-all "$minutes"
}

# part mutations: the tests detect defects in engine, solvers and robot; results of earlier nights count too
part_mutations() {
  local mutations=$root/tests/mutations/run status=0 kills
  need "$mutations"
  "$mutations" check
  "$mutations" build --jobs "$(nproc)"
  "$mutations" base
  timeout --signal=INT "${minutes}m" "$mutations" run --jobs "$(nproc)" --classes short,steps || status=$?
  [ $status -eq 0 ] || [ $status -eq 124 ] || return $status  # 124: the time ended
  "$mutations" report | tee "$results/report.md"
  kills=$(grep '^Of .* mutants that can break a promise' "$results/report.md") || { echo "no mutant was run"; return 1; }
  echo "figure: $kills"
  kills=${kills##*: }
  [ "${kills%%.*}" -ge 95 ] || { echo "error: the tests detect less than 95 % of these mutants"; return 1; }
}
