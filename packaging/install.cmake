# What is installed: `cmake --install`, the .deb and the tarball have the same files, at the same places below their prefix.
set(install_folder ${CMAKE_BINARY_DIR}/install)

# The program writes its own page in its languages, without a home to keep anything in.
foreach(lang en zh)
  add_custom_command(OUTPUT ${install_folder}/${lang}/servoctl.1.gz
    COMMAND ${CMAKE_COMMAND} -E make_directory ${install_folder}/${lang}
    COMMAND ${CMAKE_COMMAND} -E env --unset=HOME --unset=XDG_STATE_HOME
            sh -c "into=$1; shift; \"$@\" man --lang \"$0\" >\"$into\" && gzip -9nf \"$into\"" ${lang} ${install_folder}/${lang}/servoctl.1
            ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:servoctl>
    DEPENDS servoctl VERBATIM)
endforeach()

# Debian packages whose code is in the program: headers in both, archives in that of one file.
string(REGEX MATCH "^[0-9]+\\.[0-9]+" boost ${Boost_VERSION})
set(linked_packages libcli11-dev,nlohmann-json3-dev,libexpected-dev,libtomlplusplus-dev,libfmt-dev,libboost${boost}-dev)
if(SERVOCTL_STATIC)
  string(REGEX MATCH "^[0-9]+" major ${CMAKE_CXX_COMPILER_VERSION})
  string(APPEND linked_packages ,libpugixml-dev,libnl-3-dev,zlib1g-dev,libstdc++-${major}-dev,libc6-dev)
endif()
add_custom_command(OUTPUT ${install_folder}/copyright
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${CMAKE_SOURCE_DIR} -DINTO=${install_folder} -DPACKAGES=${linked_packages} -P ${CMAKE_SOURCE_DIR}/packaging/copyright.cmake
  DEPENDS ${CMAKE_SOURCE_DIR}/packaging/copyright.cmake ${CMAKE_SOURCE_DIR}/LICENSE VERBATIM)
add_custom_command(OUTPUT ${install_folder}/changelog.gz
  COMMAND sh -c "gzip -9nc \"$0\" >\"$1\"" ${CMAKE_SOURCE_DIR}/CHANGELOG.md ${install_folder}/changelog.gz
  DEPENDS ${CMAKE_SOURCE_DIR}/CHANGELOG.md VERBATIM)
add_custom_target(installed_files ALL DEPENDS ${install_folder}/en/servoctl.1.gz ${install_folder}/zh/servoctl.1.gz ${install_folder}/copyright ${install_folder}/changelog.gz)

install(TARGETS servoctl)
install(DIRECTORY eds/ DESTINATION ${CMAKE_INSTALL_DATADIR}/servoctl/eds)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY examples/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples USE_SOURCE_PERMISSIONS)
install(FILES README.md README.zh.md ${install_folder}/copyright ${install_folder}/changelog.gz DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${install_folder}/licenses DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${install_folder}/en/servoctl.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${install_folder}/zh/servoctl.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/zh_CN/man1)
install(FILES completions/servoctl.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME servoctl)
install(FILES completions/_servoctl DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(FILES completions/servoctl.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(FILES packaging/60-servoctl.rules DESTINATION lib/udev/rules.d)

set(SERVOCTL_MAINTAINER "The servoctl developers <noreply@example.org>" CACHE STRING "Who packs it, for the .deb: NAME <ADDRESS>")
set(CPACK_GENERATOR DEB)
if(SERVOCTL_STATIC)
  list(APPEND CPACK_GENERATOR TGZ)
endif()
set(CPACK_PACKAGE_NAME servoctl)
set(CPACK_PACKAGE_VENDOR "The servoctl developers")
set(CPACK_PACKAGE_CONTACT "${SERVOCTL_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "commission CANopen servo drives from a terminal")
set(CPACK_PACKAGE_DESCRIPTION "servoctl finds and identifies the servo drives on a bus (CANopen on CAN,
CANopen over EtherCAT, Modbus), reads and changes their parameters by the
numbers of their manuals, shows states and faults, saves, compares and restores
settings, maps PDOs and turns motors for a test: by single commands, at a
prompt, and in scripts. Simulated drives come with it.")
set(CPACK_STRIP_FILES ON)
set(CPACK_RESOURCE_FILE_LICENSE ${CMAKE_SOURCE_DIR}/LICENSE)
set(CPACK_DEBIAN_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "can-utils, libcap2-bin")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_SOURCE_DIR}/packaging/postinst)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_SOURCE_DIR}/packaging/pack.cmake)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_SOURCE_DIR}/packaging/packed_files.cmake)
set(CPACK_SERVOCTL_BUILD ${CMAKE_BINARY_DIR})
set(CPACK_SERVOCTL_PROCESSOR ${CMAKE_SYSTEM_PROCESSOR})
set(CPACK_SERVOCTL_SOURCE ${CMAKE_SOURCE_DIR})
include(CPack)
