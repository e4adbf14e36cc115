#!/usr/bin/env bash
# Installs the .deb with dpkg where there is nothing but libc, a shell and man, and uses it there. The few packages of that root are
# unpacked, not installed: that takes two seconds, where debootstrap takes minutes, and leaves nothing in it that could help.
# Exits with 125 where there is neither root nor a user namespace, or no network the first time.
# usage: clean_root_test.sh SERVOCTL BUILD_DIR
set -euo pipefail
build=$(readlink -f "$2")
if [ "${CLEAN_ROOT-}" != inside ]; then
  enter=(unshare --mount)
  [ "$(id -u)" -eq 0 ] || enter=(unshare --map-root-user --mount)
  "${enter[@]}" true 2>/dev/null || { echo "no mount namespace here"; exit 125; }
  CLEAN_ROOT=inside exec "${enter[@]}" "$0" "$@"
fi
for tool in dpkg dpkg-shlibdeps apt-get cpack; do
  command -v "$tool" >/dev/null || { echo "$tool is missing"; exit 125; }
done
packages=(libc6 libgcc-s1 gcc-12-base libcrypt1 dash man-db libpipeline1 libgdbm6 libseccomp2 zlib1g)
cache=$build/clean-root
mkdir -p "$cache"
work=$(mktemp -d)
trap 'umount -R "$work/root/proc" 2>/dev/null || true; rm -rf --one-file-system "$work"' EXIT
if [ "$(find "$cache" -name '*.deb' | wc -l)" -ne ${#packages[@]} ]; then
  rm -f "$cache"/*.deb
  (cd "$cache" && timeout 60 apt-get download -qq -o APT::Sandbox::User=root "${packages[@]}" >"$work/log" 2>&1) ||
    { cat "$work/log"; rm -f "$cache"/*.deb; echo "the packages of the root cannot be downloaded"; exit 125; }
fi

root=$work/root
mkdir -p "$root"/{proc,dev,etc,var/lib/dpkg/{info,updates},var/log} "$root"/usr/{bin,sbin,lib,lib64}
for folder in bin sbin lib lib64; do ln -s "usr/$folder" "$root/$folder"; done
: >"$root/var/lib/dpkg/available"
for package in "$cache"/*.deb; do
  dpkg-deb --fsys-tarfile "$package" | tar -x -C "$root" --keep-directory-symlink --no-same-owner
  dpkg-deb -f "$package" | sed '/^Version:/i Status: install ok installed' >>"$root/var/lib/dpkg/status"
  echo >>"$root/var/lib/dpkg/status"
  name=$(dpkg-deb -f "$package" Package)
  [ "$(dpkg-deb -f "$package" Multi-Arch)" != same ] || name+=:$(dpkg-deb -f "$package" Architecture)
  : >"$root/var/lib/dpkg/info/$name.list"
done
ln -sf dash "$root/usr/bin/sh"
echo 'root:x:0:0:root:/:/bin/sh' >"$root/etc/passwd"
echo 'MANDATORY_MANPATH /usr/share/man' >"$root/etc/manpath.config"
mount --rbind /proc "$root/proc"
if env -i chroot "$root" /usr/bin/ls / 2>/dev/null; then echo "the root is not clean"; exit 1; fi

cpack --config "$build/CPackConfig.cmake" -G DEB -B "$work/packed" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
# An older package, with a file that the present one has no more, is what most people have.
dpkg-deb -R "$work"/packed/*.deb "$work/older"
sed -i 's/^Version: .*/Version: 0.0.1-1/' "$work/older/DEBIAN/control"
gone=usr/share/servoctl/eds/gone.eds
echo gone >"$work/older/$gone"
dpkg-deb --root-owner-group -b "$work/older" "$work/older.deb" >"$work/log"
told=$(dpkg --root="$root" --force-not-root -i "$work/older.deb" 2>&1) || { echo "dpkg refuses the older one: $told"; exit 1; }
[ -s "$root/$gone" ] || { echo "the older package is not installed"; exit 1; }
updated=$(dpkg --root="$root" --force-not-root -i "$work"/packed/*.deb 2>&1) || { echo "dpkg refuses to update: $updated"; exit 1; }
failures=0
fail() { echo "FAILED $*"; failures=$((failures + 1)); }
inside() { env -i LC_ALL=C PATH=/usr/bin:/usr/sbin chroot "$root" "$@" 2>&1 || true; }

[[ $told == *'setcap cap_net_raw+ep /usr/bin/servoctl'* ]] || fail "the capability is not told: $told"
[[ $updated == *'are gone'* ]] || fail "that an update takes the capability away is not told: $updated"
[ ! -e "$root/$gone" ] || fail "an update leaves $gone"
[ "$(dpkg --root="$root" --force-not-root -s servoctl | grep -c '^Status: install ok installed')" -eq 1 ] || fail "an update leaves it half installed"
answer=$(inside servoctl --version)
[ "$answer" = "servoctl $(head -1 "$build/version/version.txt")" ] || fail "--version: $answer"
answer=$(inside servoctl drives)
grep -q '^gsd600' <<<"$answer" || fail "drives: $answer"
answer=$(inside servoctl scan -b sim:gsd600@1)
grep -q '^ *1 .*gsd600' <<<"$answer" || fail "scan: $answer"
answer=$(inside servoctl param get Pn0214 -b sim:gsd600@1 -n 1 -d gsd600)
grep -q '60 Hz' <<<"$answer" || fail "param get: $answer"
answer=$(inside man -w servoctl)
[ "$answer" = /usr/share/man/man1/servoctl.1.gz ] || fail "man -w: $answer"
for file in bash-completion/completions/servoctl zsh/vendor-completions/_servoctl fish/vendor_completions.d/servoctl.fish; do
  [ -s "$root/usr/share/$file" ] || fail "$file is missing"
done
for file in docs/json.md docs/schema/envelope.schema.json README.md README.zh.md copyright; do
  [ -s "$root/usr/share/doc/servoctl/$file" ] || fail "doc/servoctl/$file is missing"
done
if command -v getcap >/dev/null && [ -n "$(getcap "$root/usr/bin/servoctl")" ]; then fail "a capability was set"; fi
dpkg --root="$root" --force-not-root -P servoctl >"$work/log" 2>&1 || fail "it cannot be removed: $(cat "$work/log")"
left=$(find "$root" -xdev -name '*servoctl*' -not -path '*/var/log/*' | head -5)
[ -z "$left" ] || fail "removing it leaves $left"
[ "$failures" -eq 0 ] || exit 1
echo "installed, updated, used and removed in a root of libc, dash and man"
