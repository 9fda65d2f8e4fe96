#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds a release and measures it; prints one table: row, mesh, ours, reference, ratio, target, met or not.
#   tests/bench/run.sh [stream] [simplify] [hull] [silhouette] [visibility] [clip] [draw] [link] [server] [--models DIR] [--quick] [--json F]
# Without a group: all of them. Without --models: ../shared/models when there, else generated meshes. Any good mesh can be
# put in DIR. --quick takes the three smallest real meshes (or the generated ones) and shortens the load run.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
case " $* " in *" -h "* | *" --help "*) sed -n '3,6s/^# \{0,1\}//p' "$0"; exit 0 ;; esac
deploy/packages.sh build run test bench
mkdir -p build/release
cmake --preset release -DLIMN_BUILD_TESTS=ON -DLIMN_BUILD_BENCH=ON >build/release/configure.log 2>&1 || {
  cat build/release/configure.log >&2
  exit 1
}
# What the groups asked for need.
targets=
for group in "$@"; do
  case $group in
    silhouette) targets="$targets limn-silhouette-bench" ;;
    visibility) targets="$targets limn-visibility-bench limn-device-visibility-bench" ;;
    draw) targets="$targets limn-draw-bench" ;;
    hull) targets="$targets limn-hull-bench" ;;
    simplify) targets="$targets limn-prepare limn-simplify-bench" ;;
    stream) targets="$targets limn-prepare limn-server limn-client limn-codec-bench limn-selection-bench" ;;
    clip) targets="$targets limn-prepare limn-clip-bench limn-contour-bench" ;;
    link) targets="$targets limn-prepare limn-server limn-client" ;;
    server) targets="$targets limn-prepare limn-server limn-load limn-delivery-bench" ;;
  esac
done
[ -n "$targets" ] || targets="limn-codec-bench limn-clip-bench limn-contour-bench limn-hull-bench limn-prepare limn-server limn-client limn-load limn-visibility-bench limn-device-visibility-bench limn-draw-bench limn-selection-bench limn-delivery-bench limn-simplify-bench limn-silhouette-bench"
# shellcheck disable=SC2086 # a list
cmake --build --preset release --target $targets >build/release/bench-build.log 2>&1 || {
  tail -n 40 build/release/bench-build.log >&2
  echo "run.sh: the build failed (above)" >&2
  exit 1
}
# Relative paths on the command line are the caller's, so python runs where this was called.
cd "$OLDPWD"
LIMN_BIN=$here/../../build/release/bin exec python3 -B "$here/bench.py" "$@"
