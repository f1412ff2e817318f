# What is installed, as two components: cli needs neither Qt nor a display, desktop is the window.
include(GNUInstallDirs)

install(TARGETS isoslider-cli RUNTIME COMPONENT cli)
# Started by the programs, not by people.
install(TARGETS isoslider-reader RUNTIME DESTINATION libexec/isoslider COMPONENT cli)
install(FILES ${PROJECT_SOURCE_DIR}/packaging/completions/isoslider-cli
  DESTINATION share/bash-completion/completions COMPONENT cli)
install(FILES ${PROJECT_SOURCE_DIR}/packaging/completions/_isoslider-cli
  DESTINATION share/zsh/site-functions COMPONENT cli)
install(FILES ${PROJECT_SOURCE_DIR}/packaging/desktop/isoslider-cli.1
  DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT cli)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/isoslider-cli COMPONENT cli)

if(ISOSLIDER_BUILD_UI)
  install(TARGETS isoslider RUNTIME COMPONENT desktop)
  install(FILES ${PROJECT_SOURCE_DIR}/packaging/desktop/isoslider.desktop
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/applications COMPONENT desktop)
  install(FILES ${PROJECT_SOURCE_DIR}/packaging/desktop/isoslider.metainfo.xml
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/metainfo COMPONENT desktop)
  install(FILES ${PROJECT_SOURCE_DIR}/packaging/desktop/isoslider-mime.xml
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/mime/packages RENAME isoslider.xml COMPONENT desktop)
  install(FILES ${PROJECT_SOURCE_DIR}/resources/icons/isoslider.svg
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/icons/hicolor/scalable/apps COMPONENT desktop)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/resources/samples
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/isoslider COMPONENT desktop)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/isoslider COMPONENT desktop)
endif()

set(CPACK_GENERATOR "DEB;TGZ")
set(CPACK_PACKAGE_NAME isoslider)
set(CPACK_PACKAGE_VENDOR "ISOSLIDER")
set(CPACK_PACKAGE_CONTACT "The ISOSLIDER maintainers <maintainers@isoslider.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Slide isosurfaces through large volumes")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 0)
set(CPACK_COMPONENTS_ALL cli)
if(ISOSLIDER_BUILD_UI)
  list(APPEND CPACK_COMPONENTS_ALL desktop)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_CLI_PACKAGE_NAME isoslider-cli)
set(CPACK_DEBIAN_DESKTOP_PACKAGE_NAME isoslider)
set(CPACK_DEBIAN_CLI_PACKAGE_SECTION science)
set(CPACK_DEBIAN_DESKTOP_PACKAGE_SECTION science)
# Qt itself only recommends the plugin that draws on X11.
set(CPACK_DEBIAN_DESKTOP_PACKAGE_DEPENDS "qt6-qpa-plugins, libgl1-mesa-dri | libgl1")
set(CPACK_COMPONENT_CLI_DESCRIPTION "Index volumes, slide isosurfaces through them, export and check meshes.")
set(CPACK_COMPONENT_DESKTOP_DESCRIPTION "The window: the isovalue handle is the surface.")
find_program(DPKG_SHLIBDEPS dpkg-shlibdeps)
if(DPKG_SHLIBDEPS)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
endif()
include(CPack)
