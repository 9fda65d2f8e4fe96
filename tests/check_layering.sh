#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/check_layering.sh [REPO]. Prints every include that crosses a layer; exit 1 if there is one.
# Include paths are repository paths, so one grep per rule is enough.
cd "${1:-$(dirname "$0")/..}" || exit 2
status=0

# forbid FOLDERS PATTERN REASON [ALLOWED]: no file in FOLDERS, but for those matching ALLOWED, includes PATTERN.
forbid() {
  # Word splitting of the folder list is the point.
  # shellcheck disable=SC2086
  found=$(grep -rnE --include='*.h' --include='*.cpp' "^ *# *include *[<\"]($2)" $1 2>/dev/null |
    grep -vE "^(${4:-//})")
  [ -z "$found" ] && return
  printf '%s\n  forbidden: %s\n' "$found" "$3"
  status=1
}

gl='EGL/|GLES|GL/'
forbid "shared"          '(protocol|server|client|tests)/'  'shared is the bottom layer'
forbid "shared protocol" "$gl"  'in shared, GL lives in shared/gl'  'shared/gl/'
forbid "shared protocol" 'libwebsockets|opencv2/|OpenMesh/|CGAL/'  'shared and protocol are pure'
forbid "shared protocol" 'spdlog/|CLI/'  'no logging and no command lines below server and client'
forbid "shared protocol" '(iostream|fstream|filesystem|thread|mutex|chrono)>'  'no IO, threads or clocks below server and client'  'shared/core/mutex.h'
# Inside shared: gl, codec -> progressive, silhouette -> view -> mesh -> core.
forbid "shared/core"     'shared/(mesh|ray|progressive|view|silhouette|codec|gl)/'  'core includes only core'
forbid "shared/mesh"     'shared/(ray|progressive|view|silhouette|codec|gl)/'  'mesh sits on core alone'
forbid "shared/view"     'shared/(progressive|silhouette|codec|gl)/'  'view sits on mesh and core'
forbid "shared/ray"      'shared/(view|progressive|silhouette|codec|gl)/'  'ray sits on mesh and core'
forbid "shared/progressive shared/silhouette" 'shared/(codec|gl)/'  'codec and gl sit above the algorithms'
forbid "shared/codec"    'shared/gl/'  'codecs do not draw'
forbid "shared/gl"       'shared/(progressive|silhouette|codec)/'  'gl wraps GL, it knows no algorithm'
forbid "shared/plot"     'shared/(mesh|progressive|view|silhouette|codec|gl)/'  'plot draws numbers, whatever they measure'
forbid "protocol"        '(server|client|tests)/|shared/(mesh|progressive|view|silhouette|codec)/|draco/'  'protocol sees only shared/core'
forbid "server"          '(client|tests)/'  'server and client meet only in protocol'
forbid "client"          '(server|tests)/'  'server and client meet only in protocol'
forbid "client/core client/stroke client/svg" "client/(net|render|pose|apps)/|shared/gl/|$gl|libwebsockets"  'client/core, client/stroke and client/svg are headless'
forbid "server/session"  'server/(transport|preprocess|apps)/|libwebsockets'  'sessions see only interfaces'
forbid "server/contour"  '(protocol|server/(store|session|transport|preprocess|apps))/'  'contours are found in shared terms alone'
forbid "server/store"    'server/(session|transport|preprocess|apps)/'  'the store sits below its users'
forbid "server/preprocess" 'server/(session|transport|apps)/'  'preparation knows the store alone'
forbid "server/transport"  'server/(preprocess|apps)/'  'transport carries sessions, it prepares nothing'
forbid "client/net client/render client/pose" 'client/apps/'  'only apps join implementations'
forbid "shared protocol server client" 'draco/'          'Draco lives in shared/codec'       'shared/codec/'
forbid "server client"   'OpenMesh/|CGAL/'               'OpenMesh and CGAL live in server/preprocess' 'server/preprocess/'
forbid "shared protocol server client" 'prometheus/' 'prometheus-cpp lives in server/transport' 'server/transport/'
forbid "server client"   'libwebsockets'                 'libwebsockets lives in two folders' '(server/transport|client/net)/'
forbid "server client"   "$gl"                           'GL lives in client/render, OSMesa also in server/preprocess'  '(client/render|server/preprocess)/'
forbid "server client"   'opencv2/'                      'OpenCV lives in client/pose and server/preprocess'  '(client/pose|server/preprocess)/'
exit $status
