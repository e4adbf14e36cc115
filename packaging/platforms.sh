#!/usr/bin/env bash
# What is shipped, for each Debian release and processor: built without a warning, packed, and installed and used in a minimal root
# of its own; with `tests` the whole suite runs as well, for arm64 the tests of the program. Each release has a root to build in, made by
# debootstrap in build/platforms and kept; arm64 is cross-built there and run by qemu. Packages end in build/package. For root, with
# the network.
# usage: platforms.sh packages|tests [RELEASE…]
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
readonly what=$1 kept=$PWD/build/platforms
shift
releases=("$@")
[ ${#releases[@]} -gt 0 ] || releases=(bookworm trixie)
die() { echo "platforms: $*" >&2; exit 1; }

[ "$(id -u)" -eq 0 ] || die "only root can make the roots"
if [ "${PLATFORMS-}" != inside ]; then
  PLATFORMS=inside exec unshare --mount "$0" "$what" "${releases[@]}"
fi
[ -e /proc/sys/fs/binfmt_misc/qemu-aarch64 ] || die "programs of arm64 do not run here: apt-get install qemu-user-static binfmt-support"

inside() {  # inside RELEASE COMMAND…
  env -i CI=true LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive chroot "$kept/$1" bash -ec "${*:2}"
}

# A root with the compilers for both processors, and the libraries of both.
make_root() {
  local root=$kept/$1
  if [ ! -d "$root" ]; then
    mkdir -p "$kept"
    rm -rf --one-file-system "$root.part"
    debootstrap --variant=minbase "$1" "$root.part" >"$kept/$1.log" || { tail -5 "$kept/$1.log"; die "debootstrap cannot make a root of $1"; }
    mv "$root.part" "$root"
  fi
  mount --bind "$root" "$root"  # What is tested unshares mounts, which needs a root that is one.
  for folder in proc sys dev; do mount --rbind "/$folder" "$root/$folder"; done
  inside "$1" "dpkg --add-architecture arm64; apt-get update -qq
    apt-get install -y -qq --no-install-recommends ca-certificates debootstrap git g++-aarch64-linux-gnu pkgconf:arm64 {libfmt-dev,libpugixml-dev,libnl-3-dev,libboost-context-dev,zlib1g-dev,libc6,libstdc++6}:arm64 >/dev/null"
}

# The commit that is checked out here.
take_source() {
  local source=$kept/$1/servoctl
  [ -d "$source" ] || git clone -q . "$source"
  git -C "$source" fetch -q --tags "$PWD" HEAD
  git -C "$source" checkout -q --detach FETCH_HEAD
}

for release in "${releases[@]}"; do
  echo "== $release"
  make_root "$release"
  take_source "$release"
  if [ "$what" = tests ]; then inside "$release" "cd /servoctl; ./dev test"; fi
  inside "$release" "cd /servoctl; ./dev package; tests/real/clean_root_test.sh build/release/servoctl build/release
    cmake --preset arm64 >/dev/null
    cmake --build --preset arm64 -j \$(nproc) >/dev/null
    DEB_HOST_ARCH=arm64 cpack --config build/arm64/CPackConfig.cmake -B build/package >/dev/null
    rm -rf build/package/_CPack_Packages
    DEB_HOST_ARCH=arm64 tests/real/clean_root_test.sh build/arm64/servoctl build/arm64"
  if [ "$what" = tests ]; then inside "$release" "cd /servoctl; ctest --preset arm64 -j \$(nproc) -R '^Program'"; fi
  rm -rf "build/package/$release"
  mkdir -p "build/package/$release"
  cp "$kept/$release"/servoctl/build/package/servoctl* "build/package/$release/"
done
ls build/package/*/servoctl*
