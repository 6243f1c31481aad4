#!/usr/bin/env bash
# Runs a test of the pages. If a file or program is missing, reports it and skips the test.
#   where_it_is_built.sh ROOT COMMAND...
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
root=$1
shift
for needed in web/{live,report,report_with_anatomy}.html wasm/keepout.wasm web/fetched_for_tests.json; do
  [ -f "$root/build/$needed" ] ||
    { echo "skipped: there is no build/$needed; apps/web/build tests makes it"; exit 77; }
done
browser=(chromium)
[ "${KEEPOUT_BROWSER:-}" != firefox ] || browser=(firefox-esr Xvfb)
for program in node npm "${browser[@]}"; do
  command -v "$program" >/dev/null ||
    { echo "skipped: there is no $program; cmake/debian_packages_web.txt has what the tests need"; exit 77; }
done
exec "$@"
