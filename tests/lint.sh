#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs clang-tidy (.clang-tidy) over source files and reports. Not part of tests/run.sh: it takes minutes.
#   tests/lint.sh             files changed against main (or since the last commit on main), committed or not
#   tests/lint.sh --all       every source file
#   tests/lint.sh FILE...     these
set -eu
cd "$(dirname "$0")/.."
case ${1:-} in -h | --help) sed -n '3,6s/^# \{0,1\}//p' "$0"; exit 0 ;; esac
deploy/packages.sh build test
# clang's own flags: gcc's compile commands would name options that clang-tidy does not know.
[ -f build/asan/compile_commands.json ] || cmake --preset asan >/dev/null
cmake --build --preset asan --target limn_protocol_generated >/dev/null

case ${1:-} in
  --all) files=$(git ls-files --cached --others --exclude-standard '*.cpp') ;;
  '')
    base=$(git merge-base HEAD main 2>/dev/null || git rev-parse HEAD~1)
    [ "$base" != "$(git rev-parse HEAD)" ] || base=$(git rev-parse HEAD~1)
    files=$({ git diff --name-only --diff-filter=d "$base"; git ls-files --others --exclude-standard; } | grep '\.cpp$' | sort -u || true)
    ;;
  *) files=$(printf '%s\n' "$@") ;;
esac
[ -n "$files" ] || { echo "lint: nothing changed"; exit 0; }
# Files that this configuration does not compile have no entry, and clang-tidy could only guess.
known=
for file in $files; do
  if grep -q "/$file\"" build/asan/compile_commands.json; then known="$known $file"; else echo "lint: $file is not compiled, skipped" >&2; fi
done
# shellcheck disable=SC2086
printf '%s\n' $known | xargs -r -P "${LIMN_JOBS:-$(nproc)}" -n 1 clang-tidy -p build/asan --quiet --extra-arg=-Wno-unknown-warning-option 2>/dev/null &&
  echo "lint: clean"
