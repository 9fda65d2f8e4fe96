#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds a release and plays the load scripts beside this file, each against a server of its own; prints one table.
#   tests/load/run.sh [SCRIPT...] [--models DIR] [--soak] [--tls] [--bare] [--drain N]
#                     [--restart N] [--memory] [--plot SVG] [--json F]
# Without a script: all but soak.toml (--soak: that too). Models: those that scripts name, from DIR (default:
# ../shared/models when there, else generated shapes of the same names). --plot: latency against the number of orbiting
# clients, 1 to 200. --tls: scripts over wss, certificate checked. --bare: each script of one model against a bare
# libwebsockets server as well. --drain: SIGTERM with N clients connected. --restart: kill -9 under N clients that decode
# everything, and a new server. --memory: what a client costs, from the server's memory with few and with many.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
case " $* " in *" -h "* | *" --help "*) sed -n '3,11s/^# \{0,1\}//p' "$0"; exit 0 ;; esac
cd "$here/../.."
deploy/packages.sh build run test
mkdir -p build/release
cmake --preset release >build/release/configure.log 2>&1 || { cat build/release/configure.log >&2; exit 1; }
cmake --build --preset release --target limn-prepare limn-server limn-load limn-bare-server >build/release/load-build.log 2>&1 || {
  tail -n 40 build/release/load-build.log >&2
  exit 1
}
# Relative paths on the command line are the caller's, so python runs where this was called.
cd "$OLDPWD"
LIMN_BIN=$here/../../build/release/bin exec python3 -B "$here/run.py" "$@"
