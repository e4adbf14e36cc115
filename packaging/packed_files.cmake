# Run by cpack when the files stand in its folder: in the tarball the program of one file takes the place of the other; what Debian has
# at another place or in another form is put there.
cmake_minimum_required(VERSION 3.25)
if(NOT CPACK_GENERATOR STREQUAL "DEB")
  file(GLOB_RECURSE program ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*bin/servoctl)
  configure_file(${CPACK_SERVOCTL_BUILD}/static/servoctl ${program} COPYONLY)
  return()
endif()
set(share ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/usr/share)
set(doc ${share}/doc/servoctl)
set(from ${CPACK_SERVOCTL_SOURCE}/packaging)
file(REMOVE_RECURSE ${doc}/licenses)  # They are in /usr/share/common-licenses.
file(MAKE_DIRECTORY ${share}/zsh/vendor-completions)
file(RENAME ${share}/zsh/site-functions/_servoctl ${share}/zsh/vendor-completions/_servoctl)
file(REMOVE_RECURSE ${share}/zsh/site-functions)
configure_file(${from}/README.Debian ${doc}/README.Debian COPYONLY)
execute_process(COMMAND env LC_ALL=C date -R -u -d ${CPACK_SERVOCTL_DATE} OUTPUT_VARIABLE day OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
file(WRITE ${doc}/changelog.Debian "servoctl (${CPACK_PACKAGE_VERSION}-1) unstable; urgency=medium

  * servoctl ${CPACK_PACKAGE_VERSION}; changelog.gz says what is new.

 -- ${CPACK_PACKAGE_CONTACT}  ${day}
")
execute_process(COMMAND gzip -9nf ${doc}/changelog.Debian COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND chmod -R u+rwX,go+rX,go-w ${CPACK_TEMPORARY_INSTALL_DIRECTORY} COMMAND_ERROR_IS_FATAL ANY)
