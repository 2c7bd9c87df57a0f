# What `cmake --install` puts where, in three components: the program and the Python module, of which Debian packages are made, and the libraries
# for other programs (docs/library.md).
install(TARGETS supple COMPONENT program)
install(TARGETS supple-read-surface supple-bench DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/supple COMPONENT program)
install(FILES assets/completion/supple.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME supple COMPONENT program)
install(DIRECTORY assets shaders DESTINATION ${CMAKE_INSTALL_DATADIR}/supple COMPONENT program)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT program)

# The manual is what the program says of itself.
add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/supple.1.gz
                   COMMAND ${PROJECT_SOURCE_DIR}/cmake/man_page $<TARGET_FILE:supple> ${PROJECT_BINARY_DIR}/supple.1.gz
                   DEPENDS supple ${PROJECT_SOURCE_DIR}/cmake/man_page VERBATIM)
add_custom_target(supple_man_page ALL DEPENDS ${PROJECT_BINARY_DIR}/supple.1.gz)
install(FILES ${PROJECT_BINARY_DIR}/supple.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)

include(CMakePackageConfigHelpers)
set(supple_config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/supple)
# Films, pictures and their files are the program's own affair.
list(FILTER supple_libraries EXCLUDE REGEX "^supple_(render|output|film|live)$")
install(TARGETS ${supple_libraries} EXPORT supple-targets ARCHIVE COMPONENT libraries)
install(CODE "set(engine ${PROJECT_SOURCE_DIR}/engine)
set(folder ${CMAKE_INSTALL_INCLUDEDIR}/supple)" COMPONENT libraries)
install(SCRIPT cmake/install_headers.cmake COMPONENT libraries)
install(EXPORT supple-targets NAMESPACE supple:: DESTINATION ${supple_config_folder} COMPONENT libraries)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/supple-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/supple-config.cmake cmake/FindCHOLMOD.cmake ${PROJECT_BINARY_DIR}/supple-config-version.cmake
        DESTINATION ${supple_config_folder} COMPONENT libraries)

# `cpack` in a build folder of the preset `portable` makes the Debian package. Libraries that are linked are found by
# dpkg-shlibdeps; the others are opened or run by name when they are wanted.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR "The supple authors")
set(CPACK_PACKAGE_CONTACT "The supple authors <supple@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "films of soft bodies, from a scene file, in a terminal")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "supple simulates hyperelastic bodies and cloth, draws them with software OpenGL\nand leaves a video, a frame-time \
profile and the error of every frame. It needs\nneither a display nor a GPU.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL program)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME supple)
set(CPACK_DEBIAN_PROGRAM_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "ffmpeg, libosmesa6")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "fonts-lato, fonts-dejavu-core, gnuplot-nox, libegl1, libgl1-mesa-dri, libopenblas0-serial")
if(TARGET supple_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-supple)
  set(CPACK_DEBIAN_PYTHON_FILE_NAME DEB-DEFAULT)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "supple (= ${PROJECT_VERSION}), python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next_minor}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "films of soft bodies, for Python\nScenes in time, bodies made of arrays, and pictures.")
endif()
include(CPack)
