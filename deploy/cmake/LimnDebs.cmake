# SPDX-License-Identifier: Apache-2.0
# What is installed where, and the Debian packages of it: `deploy/debs.sh` makes limn-server and limn-client.
install(TARGETS limn-client limn-load RUNTIME DESTINATION bin COMPONENT client)
if(LIMN_BUILD_SERVER)
  install(TARGETS limn-server limn-prepare RUNTIME DESTINATION bin COMPONENT server)
  install(FILES "${PROJECT_SOURCE_DIR}/deploy/systemd/limn-server.service"
    DESTINATION /usr/lib/systemd/system COMPONENT server)
  install(FILES "${PROJECT_SOURCE_DIR}/deploy/limn-server.toml"
    DESTINATION /etc/limn RENAME server.toml COMPONENT server)
endif()

# Made by deploy/debs.sh before it packs: manual pages from --help, and what Debian asks of every package.
set(LIMN_DEB_FILES "${PROJECT_BINARY_DIR}/debs" CACHE PATH "Manual pages, copyright and changelog")
foreach(component server client)
  install(DIRECTORY "${LIMN_DEB_FILES}/${component}/" DESTINATION share COMPONENT ${component} OPTIONAL)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/debs")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGE_CONTACT "The Limn authors <limn@example.org>")
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_COMPONENTS_ALL server client)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
foreach(component SERVER CLIENT)
  set(CPACK_DEBIAN_${component}_PACKAGE_SECTION graphics)
endforeach()
set(CPACK_DEBIAN_SERVER_PACKAGE_NAME limn-server)
set(CPACK_DEBIAN_CLIENT_PACKAGE_NAME limn-client)
# Opened at run time, so that no linker names them.
set(CPACK_DEBIAN_SERVER_PACKAGE_DEPENDS "libosmesa6, libwebsockets-evlib-ev")
set(CPACK_DEBIAN_CLIENT_PACKAGE_DEPENDS "libegl1, libegl-mesa0, libwebsockets-evlib-ev")
set(CPACK_DEBIAN_CLIENT_PACKAGE_SUGGESTS "libosmesa6, limn-server")
set(CPACK_COMPONENT_SERVER_DESCRIPTION
"mesh server that streams silhouettes first
Prepares large triangle meshes once and streams them over WebSockets, so that
thin clients draw them as stylised lines at once and then better and better.")
set(CPACK_COMPONENT_CLIENT_DESCRIPTION
"line drawings of streamed meshes
Streams meshes from a Limn server and draws their silhouettes, creases and
borders as stylised strokes; and a load generator for such servers.")
set(CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_EXTRA "${PROJECT_SOURCE_DIR}/deploy/systemd/conffiles")
include(CPack)
