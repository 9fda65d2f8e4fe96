#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/check_headers.sh [REPO]. Every source file names its licence at its top: GPL-3.0-or-later where it includes
# CGAL (only in server/preprocess), Apache-2.0 everywhere else. Prints what does not; exit 1 if there is anything.
cd "${1:-$(dirname "$0")/..}" || exit 2
status=0
complain() { printf '%s: %s\n' "$1" "$2"; status=1; }

folders=
for folder in shared protocol server client tests deploy; do [ -d "$folder" ] && folders="$folders $folder"; done
# shellcheck disable=SC2086
sources=$(find $folders -type f \( -name '*.h' -o -name '*.cpp' -o -name '*.cmake' -o -name CMakeLists.txt -o -name '*.sh' \
  -o -name '*.py' -o -name '*.fbs' -o -name '*.vert' -o -name '*.frag' -o -name '*.geom' -o -name '*.glsl' \))
[ -f CMakeLists.txt ] && sources="CMakeLists.txt
$sources"
while IFS= read -r file; do
  [ -n "$file" ] || continue
  # The first three lines, since an interpreter line or a shader's #version comes first.
  licence=$(head -n 3 "$file" | sed -n 's/.*SPDX-License-Identifier: *\([A-Za-z0-9.-]*\).*/\1/p' | head -n 1)
  if grep -qE '^ *# *include *[<"]CGAL/' "$file"; then expected=GPL-3.0-or-later; else expected=Apache-2.0; fi
  case $licence in
    "$expected") ;;
    '') complain "$file" "no SPDX-License-Identifier in the first three lines; add '$expected'" ;;
    GPL-3.0-or-later)
      # Everything that goes with CGAL may be GPL; nothing outside its folder may.
      case $file in
        server/preprocess/* | tests/*/server/preprocess/*) ;;
        *) complain "$file" "is GPL-3.0-or-later outside server/preprocess" ;;
      esac ;;
    *) complain "$file" "says '$licence', should say '$expected'" ;;
  esac
done <<EOF
$sources
EOF
exit $status
