# Writes the licence of servoctl and those of the libraries whose code is in the program, as the Debian packages that they came
# from tell them; and the whole texts of the common licences that those name.
# usage: cmake -DSOURCE=DIR -DINTO=DIR -DPACKAGES=a,b -P copyright.cmake
# INTO/incomplete lists packages whose licence is not there: nothing is packaged then.
cmake_minimum_required(VERSION 3.25)
file(READ ${SOURCE}/LICENSE own)
set(text "servoctl\n========\n\n${own}")
set(common_texts)
file(REMOVE_RECURSE ${INTO}/licenses ${INTO}/incomplete)
file(MAKE_DIRECTORY ${INTO}/licenses)
string(APPEND text "
What else is in the program
===========================

")
if(PACKAGES MATCHES "libc6")
  string(APPEND text "The program of the tarball is linked statically with libraries below. libnl and the GNU C library are under the
GNU Lesser General Public License 2.1: you may change them, link the program anew with them, and take it apart for that. The sources
of servoctl, which are free, are all that is needed: build them with your own archives, or against the
shared libraries of the system (cmake --preset release makes both programs). Who hands on the program hands on, or offers, the sources of servoctl in
this version and of these two libraries; Debian has the latter as the source packages named below (apt-get source NAME=VERSION).
The GNU C++ library is under the GNU General Public License 3 with the GCC Runtime Library Exception 3.1, which lets programs be
linked with it under any terms.

")
endif()
string(APPEND text "The terms of each, as its Debian package tells them; some files that they name are not part of what is used here.
")
string(REPLACE "," ";" PACKAGES "${PACKAGES}")
foreach(package IN LISTS PACKAGES)
  set(file /usr/share/doc/${package}/copyright)
  if(NOT EXISTS ${file})
    file(APPEND ${INTO}/incomplete "${package}\n")
    continue()
  endif()
  # A package that is installed for two processors is listed twice, in the same version.
  execute_process(COMMAND dpkg-query -W -f "\${source:Package} \${source:Version}\n" ${package} OUTPUT_VARIABLE from ERROR_QUIET)
  string(REGEX REPLACE "\n.*" "" from "${from}")
  file(READ ${file} terms)
  set(title "${package} (source: ${from})")
  string(REGEX REPLACE "." "-" line "${title}")
  string(APPEND text "\n\n${title}\n${line}\n\n${terms}")
  string(REGEX MATCHALL "/usr/share/common-licenses/[A-Za-z0-9.-]*[A-Za-z0-9]" names "${terms}")
  list(APPEND common_texts ${names})
endforeach()
list(REMOVE_DUPLICATES common_texts)
foreach(common IN LISTS common_texts)
  get_filename_component(name ${common} NAME)
  if(EXISTS ${common})
    file(READ ${common} terms)
    file(WRITE ${INTO}/licenses/${name} "${terms}")
  endif()
endforeach()
file(WRITE ${INTO}/copyright "${text}")
