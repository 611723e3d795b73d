# What `cmake --install` puts where, and the Debian package of it. Included by the top CMakeLists.txt
# once the targets are there.
include(GNUInstallDirs)

# The manual page and the completions are the program's own words.
set(documents ${CMAKE_BINARY_DIR}/documents)
set(completion_files voxweld _voxweld voxweld.fish)
set(completion_folders ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
  ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
add_custom_command(OUTPUT ${documents}/voxweld.1 ${documents}/voxweld ${documents}/_voxweld
    ${documents}/voxweld.fish
  COMMAND ${CMAKE_COMMAND} -E make_directory ${documents}
  COMMAND voxweld manual > ${documents}/voxweld.1
  COMMAND voxweld completion bash > ${documents}/voxweld
  COMMAND voxweld completion zsh > ${documents}/_voxweld
  COMMAND voxweld completion fish > ${documents}/voxweld.fish
  DEPENDS voxweld VERBATIM)
get_property(modules GLOBAL PROPERTY VOXWELD_MODULES)
add_custom_target(voxweld_package_files ALL
  DEPENDS voxweld ${modules} ${documents}/voxweld.1)

# The package's build makes only these, not the tests besides.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY TRUE)
install(TARGETS voxweld RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# Where storage/modules/module_loader.cpp looks for them: lib/voxweld, whatever a system calls lib.
install(TARGETS ${modules} LIBRARY DESTINATION lib/voxweld)
set(doc ${CMAKE_INSTALL_DATADIR}/doc/voxweld)
install(FILES README.md configs/SETTINGS.md DESTINATION ${doc})
install(FILES LICENSE DESTINATION ${doc} RENAME copyright)
file(GLOB examples CONFIGURE_DEPENDS configs/*.toml)
install(FILES ${examples} configs/voxweld.schema.json configs/workflow.smk
  DESTINATION ${doc}/examples)
install(FILES ${documents}/voxweld.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
foreach(file folder IN ZIP_LISTS completion_files completion_folders)
  install(FILES ${documents}/${file} DESTINATION ${folder})
endforeach()

set(CPACK_GENERATOR DEB)
if(NOT CPACK_PACKAGE_CONTACT)
  set(CPACK_PACKAGE_CONTACT "The voxweld developers <voxweld@localhost>")
endif()
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES TRUE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "meshes from scanned volumes too large for memory")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"voxweld turns CT, MR and microscopy volumes into watertight, simplified and
compressed triangle meshes, by adaptive dual contouring of bricks on disk.
It reads DICOM, NRRD, MetaImage, NIfTI, HDF5, Zarr, N5, OpenVDB, VTK, MRC,
TIFF, raw files and image stacks and writes Draco and glTF; on a Slurm cluster
it runs as job arrays.")
foreach(module IN LISTS modules)
  get_target_property(name ${module} OUTPUT_NAME)
  list(APPEND module_names ${name})
endforeach()
configure_file(pipeline/package_dependencies.cmake.in documents/package_dependencies.cmake @ONLY)
set(CPACK_PROJECT_CONFIG_FILE ${documents}/package_dependencies.cmake)
include(CPack)
