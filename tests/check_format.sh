#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/check_format.sh [REPO]. Names every C++ file that clang-format (14, .clang-format) would change; exit 1 if any.
cd "${1:-$(dirname "$0")/..}" || exit 2
command -v clang-format >/dev/null || { echo "clang-format is missing: deploy/packages.sh test" >&2; exit 2; }
status=0
changed=$(find shared protocol server client tests \( -name '*.h' -o -name '*.cpp' \) -print0 |
  xargs -0 clang-format --dry-run 2>&1 | sed -n 's/^\([^:]*\):[0-9]*:[0-9]*: .*/\1/p' | sort -u)
if [ -n "$changed" ]; then
  printf '%s\n  not formatted; run: clang-format -i FILE\n' "$changed"
  status=1
fi
exit $status
