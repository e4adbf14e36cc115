# Read by cpack before each kind of package: what is known only now.
if(EXISTS ${CPACK_SERVOCTL_BUILD}/install/incomplete)
  file(READ ${CPACK_SERVOCTL_BUILD}/install/incomplete missing)
  string(REGEX REPLACE "\n" " " missing "${missing}")
  message(FATAL_ERROR "the licences of these libraries are missing in /usr/share/doc, and nothing may be handed on without them: ${missing}")
endif()
# The version of the program that was built, which may be newer than the configuration.
file(STRINGS ${CPACK_SERVOCTL_BUILD}/version/version.txt CPACK_SERVOCTL_VERSION)
list(GET CPACK_SERVOCTL_VERSION 1 CPACK_SERVOCTL_DATE)
list(GET CPACK_SERVOCTL_VERSION 0 CPACK_PACKAGE_VERSION)
# What is packed is what stands there: packing builds nothing.
set(CPACK_CMAKE_GENERATOR Ninja)
if(CPACK_GENERATOR STREQUAL "DEB")
  set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
else()
  set(CPACK_PACKAGE_FILE_NAME servoctl-${CPACK_PACKAGE_VERSION}-linux-${CPACK_SERVOCTL_PROCESSOR})
endif()
