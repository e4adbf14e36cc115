# Builds for arm64 on another machine: Debian's cross compiler, and its libraries for arm64 beside those of the machine.
# `cmake --preset release --toolchain packaging/aarch64.cmake -B build/arm64`
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(PKG_CONFIG_EXECUTABLE /usr/bin/aarch64-linux-gnu-pkg-config)
# The program writes its manual page when it is built. Where qemu is not there, the kernel has to start it by itself.
find_program(qemu_aarch64 qemu-aarch64-static)
if(qemu_aarch64)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${qemu_aarch64})
endif()
set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
