#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds, and runs the tests.
#   tests/run.sh            everything: style, layering, every test (gcc, assertions), then most of them again under
#                           the address and undefined-behaviour sanitizers (clang), with a minute of every fuzzer
#   tests/run.sh --quick    the inner loop: unit, conformance and layering tests
#   tests/run.sh --no-asan  everything but the sanitizer pass
# The environment: LIMN_MODELS, a folder of real meshes (default: ../shared/models when there; tests that need it are
# skipped otherwise); LIMN_JOBS, compile jobs (default: one a core).
set -eu
cd "$(dirname "$0")/.."

quick= asan=yes
for argument in "$@"; do
  case $argument in
    --quick) quick=yes ;;
    --no-asan) asan= ;;
    -h | --help) sed -n '3,9s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "run.sh: unknown option '$argument'; use --quick or --no-asan" >&2; exit 2 ;;
  esac
done

jobs=${LIMN_JOBS:-$(nproc)}
summaries=$(mktemp)
trap 'rm -f "$summaries"' EXIT
started=$(date +%s)
status=0

say() { printf '== %s (%d s)\n' "$*" $(($(date +%s) - started)); }

# configure PRESET: only when needed; a quiet success, a full log on failure.
configure() {
  mkdir -p "build/$1"
  cmake --preset "$1" >"build/$1/configure.log" 2>&1 || { cat "build/$1/configure.log"; exit 1; }
}

# check PRESET [TESTPRESET]: runs a preset's tests, shows them, keeps ctest's summary for the end.
check() {
  log="build/$1/ctest.log"
  { ctest --preset "${2:-$1}" -j "$jobs" 2>&1 || echo "ctest exit status $?"; } | tee "$log"
  ! grep -q '^ctest exit status' "$log" || status=1
  { printf '%s: ' "${2:-$1}"; sed -n '/tests passed,/,$p' "$log" | grep -v '^ctest exit'; } >>"$summaries"
}

deploy/packages.sh build run test
say "configuring dev"
configure dev
if [ -n "$quick" ]; then
  say "building the inner loop"
  cmake --build --preset dev -j "$jobs" --target limn_quick
  check dev quick
else
  say "building dev"
  cmake --build --preset dev -j "$jobs"
  say "testing dev"
  check dev
  if [ -n "$asan" ]; then
    say "building asan"
    configure asan
    cmake --build --preset asan -j "$jobs"
    say "testing asan"
    check asan
  fi
fi

say "done"
cat "$summaries"
exit $status
