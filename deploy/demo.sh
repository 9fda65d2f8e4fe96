#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# From a bare Debian 12 to a line drawing that came over the network:
#   deploy/demo.sh          builds a release, prepares a scanned model, serves it, draws it into limn-demo.png
#   deploy/demo.sh --keep   and leaves the server running, saying where
# A second run reuses the build and the model. Everything but the picture stays below build/.
set -eu
cd "$(dirname "$0")/.."

model=armadillo  # Stanford's scan of a clay figure, as CGAL's demo data has it: 26,002 vertices
data_package=libcgal-demo
data_file=data/meshes/armadillo.off
camera=orbit:200,12,2.75
picture=$PWD/limn-demo.png
work=$PWD/build/demo
bin=$PWD/build/release/bin

keep=
for argument in "$@"; do
  case $argument in
    --keep) keep=yes ;;
    -h | --help) sed -n '3,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "demo.sh: unknown option '$argument'; the only one is --keep" >&2; exit 2 ;;
  esac
done

say() { printf '== %s\n' "$*"; }
die() { printf 'demo.sh: %s\n' "$*" >&2; exit 1; }

server_pid=
scratch=
cleanup() {
  status=$?
  trap - EXIT INT TERM
  [ -z "$scratch" ] || rm -rf "$scratch"
  if [ -n "$server_pid" ] && { [ -z "$keep" ] || [ $status != 0 ]; }; then
    kill "$server_pid" 2>/dev/null || true
    wait "$server_pid" 2>/dev/null || true
  fi
  exit $status
}
trap cleanup EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# fetch_model: takes one mesh out of a Debian package, without installing that package or what it depends on.
fetch_model() {
  [ -s "$work/$model.off" ] && return
  say "fetching the model: $data_file of Debian's $data_package (24 MB)"
  scratch=$(mktemp -d "$work/fetch-XXXXXX")
  (
    cd "$scratch"
    apt-get -q download -o APT::Sandbox::User=root "$data_package" >download.log 2>&1 || {
      # A system whose package lists are empty or old; only root can renew them.
      as_root=
      [ "$(id -u)" = 0 ] || as_root=sudo
      $as_root apt-get -q update >>download.log 2>&1 &&
        apt-get -q download -o APT::Sandbox::User=root "$data_package" >>download.log 2>&1
    } || { tail -n 5 download.log >&2; exit 1; }
    dpkg-deb -x ./*.deb package
    tar -xzf package/usr/share/doc/libcgal-dev/data.tar.gz "$data_file"
  ) || die "could not get the model; is there network access? (apt-get download $data_package)"
  mv "$scratch/$data_file" "$work/$model.off"
  rm -rf "$scratch"
  scratch=
}

# free_port FIRST: the first port from FIRST on that nobody listens on.
free_port() {
  port=$1
  while grep -qi ":$(printf '%04X' "$port") [0-9A-F:]* 0A" /proc/net/tcp /proc/net/tcp6 2>/dev/null; do
    port=$((port + 1))
  done
  echo "$port"
}

# start_server: tries a few ports, since another program may take one between the look and the bind.
start_server() {
  for attempt in 1 2 3; do
    port=$(free_port $((8600 + 20 * (attempt - 1))))
    metrics=$(free_port $((9600 + 20 * (attempt - 1))))
    if [ -n "$keep" ]; then ignore=nohup; else ignore=; fi
    : >"$work/server.log"  # there to be read, however late the server starts
    # shellcheck disable=SC2086
    $ignore "$bin/limn-server" --store "$work/store" --listen "127.0.0.1:$port" \
      --metrics-listen "127.0.0.1:$metrics" >"$work/server.log" 2>&1 </dev/null &
    server_pid=$!
    waited=0
    while kill -0 "$server_pid" 2>/dev/null && [ $waited -lt 300 ]; do
      address=$(sed -n 's/^limn-server: listening on \(ws:[^ ]*\).*/\1/p' "$work/server.log")
      [ -z "$address" ] || return 0
      sleep 0.1
      waited=$((waited + 1))
    done
    kill "$server_pid" 2>/dev/null || true
    wait "$server_pid" 2>/dev/null || true
    server_pid=
  done
  tail -n 5 "$work/server.log" >&2
  die "the server did not start; its log is $work/server.log"
}

deploy/packages.sh build run demo
mkdir -p "$work"

if [ ! -f build/release/build.ninja ]; then
  say "configuring a release"
  mkdir -p build/release
  cmake --preset release -DLIMN_BUILD_TESTS=OFF -DLIMN_BUILD_BENCH=OFF >build/release/configure.log 2>&1 || {
    cat build/release/configure.log >&2
    die "configuring failed (above)"
  }
fi
say "building a release (minutes the first time)"
cmake --build --preset release --target limn-prepare limn-server limn-client >"$work/build.log" 2>&1 || {
  tail -n 40 "$work/build.log" >&2
  die "building failed (above; all of it in $work/build.log)"
}

fetch_model

say "preparing $model"
"$bin/limn-prepare" "$work/$model.off" --store "$work/store" --name "$model" --json >"$work/prepare.json" ||
  die "preparing failed (above)"

start_server
say "drawing over the network from $address"
"$bin/limn-client" render --server "$address" --model "$model" --until settled --error-px 0.3 --camera "$camera" \
  --size 1400x1400 --report "$work/report.json" || die "streaming failed (above); the server's log is $work/server.log"
# What lies inside the outline bends with every face, so this picture takes them all.
"$bin/limn-client" render --server "$address" --model "$model" --until complete --camera "$camera" --size 1400x1400 \
  --features suggestive --hidden off --style pencil --width 5 --out "$picture" --report "$work/complete.json" ||
  die "drawing failed (above); the server's log is $work/server.log"

python3 - "$work/prepare.json" "$work/report.json" "$work/complete.json" "$work/$model.off" <<'EOF'
import json, os, sys
prepared, report, complete = (json.load(open(path)) for path in sys.argv[1:4])
if isinstance(prepared, list): prepared = prepared[0]
mesh = prepared["mesh"]
print("   prepared: %s faces, file %.2f MB, complete stream %.0f kB" % (
    format(mesh["faces"], ","), os.path.getsize(sys.argv[4]) / 1e6,
    sum(prepared["bytes"][part] for part in ("base", "level_blocks", "splits")) / 1e3))
print("   the outline has settled with %s of %s splits: %.0f kB received, %.2f s after the start" % (
    format(report["mesh"]["splits_held"], ","), format(report["mesh"]["splits_total"], ","),
    report["bytes"]["received"] / 1e3, report["seconds"]["settled"] or 0))
print("   with all of them: %.0f kB, %.2f s" % (complete["bytes"]["received"] / 1e3, complete["seconds"]["complete"] or 0))
EOF
say "the picture is $picture"
if [ -n "$keep" ]; then
  say "the server goes on at $address (process $server_pid; end it with: kill $server_pid). Draw from it with"
  echo "   $bin/limn-client render --server $address --model $model --camera orbit:30,20 --out picture.png"
fi
