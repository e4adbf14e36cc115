# Builds for arm64 on another machine: Debian's cross compiler, and its libraries for arm64 beside those of the machine.
# `cmake --preset release --toolchain packaging/aarch64.cmake -B build/arm64`
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(PKG_CONFIG_EXECUTABLE /usr/bin/aarch64-linux-gnu-pkg-config)
# The program writes its manual page when it is built; so, too, where the kernel does not start it by itself.
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static)
set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
