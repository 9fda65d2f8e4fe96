#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The checks must be able to fail: plants violations in a small tree and expects each check to name them, and to pass a
# clean tree. Usage: self_test.sh REPO
set -u
tests=$(cd "$1/tests" && pwd)
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0
wrong() { echo "self-test: $*"; failures=$((failures + 1)); }

# plant FILE LINE...: a file with a proper licence line and these lines.
plant() {
  file=$1; shift
  mkdir -p "$tree/$(dirname "$file")"
  printf '%s\n' "// SPDX-License-Identifier: Apache-2.0" "$@" >"$tree/$file"
}
# expect CHECK FILE: the check fails and names the file, which is then removed.
expect() {
  output=$("$tests/$1" "$tree") && wrong "$1 passed although $2 breaks a rule"
  case $output in *"$2"*) ;; *) wrong "$1 does not name $2" ;; esac
  rm "$tree/$2"
}

plant shared/core/a.h '#pragma once'
plant client/net/b.cpp '#include <libwebsockets.h>'
plant server/store/c.cpp '#include "shared/core/a.h"'
plant tests/d.cpp '#include "server/store/c.h"'
plant protocol/e.h '#pragma once'
for check in check_layering.sh check_headers.sh check_format.sh; do
  "$tests/$check" "$tree" || wrong "$check complains about a clean tree"
done

while read -r file include; do
  plant "$file" "#include $include"
  expect check_layering.sh "$file"
done <<'EOF'
shared/mesh/x.cpp "server/store/asset_store.h"
shared/mesh/x.cpp <thread>
shared/core/x.h "shared/mesh/half_edge.h"
shared/mesh/x.h "shared/progressive/active_mesh.h"
shared/view/x.h <GLES3/gl32.h>
shared/progressive/x.cpp <draco/core/decoder_buffer.h>
protocol/x.h "shared/mesh/half_edge.h"
server/session/x.cpp "client/core/snapshot.h"
server/session/x.cpp <libwebsockets.h>
server/store/x.cpp <CGAL/Surface_mesh.h>
client/core/x.cpp "server/store/asset_store.h"
client/core/x.cpp <EGL/egl.h>
client/stroke/x.cpp "client/net/lws_connection.h"
client/apps/x.cpp <GLES3/gl32.h>
EOF

mkdir -p "$tree/server/preprocess" "$tree/client/apps"
echo '#pragma once' >"$tree/client/apps/x.h"
expect check_headers.sh client/apps/x.h
plant server/preprocess/x.cpp '#include <CGAL/Surface_mesh.h>'
expect check_headers.sh server/preprocess/x.cpp
printf '%s\n' '// SPDX-License-Identifier: GPL-3.0-or-later' >"$tree/client/apps/x.cpp"
expect check_headers.sh client/apps/x.cpp
cp "$1/.clang-format" "$tree/"
plant client/apps/y.cpp 'int   f( ){return 1 ;}'
expect check_format.sh client/apps/y.cpp

[ $failures = 0 ] || exit 1
