#!/usr/bin/env bash
# Installs the .deb in a minimal Debian of the release that this machine runs and of the package's processor, made by debootstrap, and uses it there: nothing of it
# was installed for servoctl but man and what the .deb depends on. The root is made once for a build folder and unpacked for each run.
# Exits with 125 for who is not root, where no mount namespace is to be had, or no network the first time.
# usage: clean_root_test.sh SERVOCTL BUILD_DIR
set -euo pipefail
build=$(readlink -f "$2")
if [ "${CLEAN_ROOT-}" != inside ]; then
  [ "$(id -u)" -eq 0 ] || { echo "only root can make another root"; exit 125; }
  unshare --mount true 2>/dev/null || { echo "no mount namespace here"; exit 125; }
  CLEAN_ROOT=inside exec unshare --mount "$0" "$@"
fi
for tool in debootstrap dpkg-deb dpkg-shlibdeps apt-get cpack; do
  command -v "$tool" >/dev/null || { echo "$tool is missing"; exit 125; }
done
release=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
mkdir -p "$build/clean-root"
work=$(mktemp -d)
root=$work/root
trap 'umount -R "$root/proc" 2>/dev/null || true; rm -rf --one-file-system "$work"' EXIT
cpack --config "$build/CPackConfig.cmake" -G DEB -B "$work/packed" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
processor=$(dpkg-deb -f "$work"/packed/*.deb Architecture)
made=$build/clean-root/$release-$processor.tar
if [ -s "$made" ]; then
  mkdir "$root"
  tar -xf "$made" -C "$root" --numeric-owner
else
  # shellcheck disable=SC2016  # apt-get expands it.
  mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' "Codename: $release" 'Component: main' | head -1)
  timeout 900 debootstrap --arch="$processor" --variant=minbase --include=man-db "$release" "$root" ${mirror:+"$mirror"} >"$work/log" 2>&1 ||
    { tail -5 "$work/log"; echo "debootstrap cannot make a root of $release for $processor"; exit 125; }
  rm -rf "$root"/var/cache/apt/archives/*.deb "$root"/var/lib/apt/lists/*
  tar -cf "$made.part" -C "$root" --numeric-owner . && mv "$made.part" "$made"
fi
mount --rbind /proc "$root/proc"
inside() { env -i LC_ALL=C PATH=/usr/bin:/usr/sbin DEBIAN_FRONTEND=noninteractive chroot "$root" "$@" 2>&1; }
if inside sh -c 'command -v servoctl || find / -xdev -name "*servoctl*" | grep .'; then echo "the root is not clean"; exit 1; fi

# What it depends on and a minimal Debian has not, from the same place as the machine's own packages.
for library in $(dpkg-deb -f "$work"/packed/*.deb Depends | tr ',' '\n' | sed 's/ *(.*//; s/ //g'); do
  # shellcheck disable=SC2016  # dpkg-query expands it.
  if inside dpkg-query -W -f='${db:Status-Status}' "$library" | grep -qx installed; then continue; fi
  file=$(find "$build/clean-root" -name "${library}_*_$processor.deb" | head -1)
  if [ -z "$file" ]; then
    (cd "$build/clean-root" && apt-get download "$library:$processor") >"$work/log" 2>&1 || { tail -5 "$work/log"; echo "$library cannot be downloaded"; exit 125; }
    file=$(find "$build/clean-root" -name "${library}_*_$processor.deb" | head -1)
  fi
  cp "$file" "$root/library.deb"
  inside dpkg -i library.deb >"$work/log" || { cat "$work/log"; echo "$library cannot be installed"; exit 1; }
done
# An older package, with a file that the present one has no more, is what most people have.
dpkg-deb -R "$work"/packed/*.deb "$work/older"
sed -i 's/^Version: .*/Version: 0.0.1-1/' "$work/older/DEBIAN/control"
gone=usr/share/servoctl/eds/gone.eds
echo gone >"$work/older/$gone"
dpkg-deb --root-owner-group -b "$work/older" "$work/older.deb" >"$work/log"
mv "$work/older.deb" "$root/older.deb"
mv "$work"/packed/*.deb "$root/newer.deb"
told=$(inside dpkg -i older.deb) || { echo "dpkg refuses the older one: $told"; exit 1; }
[ -s "$root/$gone" ] || { echo "the older package is not installed"; exit 1; }
updated=$(inside dpkg -i newer.deb) || { echo "dpkg refuses to update: $updated"; exit 1; }
failures=0
fail() { echo "FAILED $*"; failures=$((failures + 1)); }

[[ $told == *'setcap cap_net_raw+ep /usr/bin/servoctl'* ]] || fail "the capability is not told: $told"
[[ $updated == *'are gone'* ]] || fail "that an update takes the capability away is not told: $updated"
[ ! -e "$root/$gone" ] || fail "an update leaves $gone"
[ "$(inside dpkg -s servoctl | grep -c '^Status: install ok installed')" -eq 1 ] || fail "an update leaves it half installed"
answer=$(inside servoctl --version || true)
[ "$answer" = "servoctl $(head -1 "$build/version/version.txt")" ] || fail "--version: $answer"
answer=$(inside servoctl drives || true)
grep -q '^gsd600' <<<"$answer" || fail "drives: $answer"
answer=$(inside servoctl scan -b sim:gsd600@1 || true)
grep -q '^ *1 .*gsd600' <<<"$answer" || fail "scan: $answer"
answer=$(inside servoctl param get Pn0214 -b sim:gsd600@1 -n 1 -d gsd600 || true)
grep -q '60 Hz' <<<"$answer" || fail "param get: $answer"
answer=$(inside man -w servoctl || true)
[ "$answer" = /usr/share/man/man1/servoctl.1.gz ] || fail "man -w: $answer"
answer=$(inside man -L zh_CN.UTF-8 -w servoctl || true)
[ "$answer" = /usr/share/man/zh_CN/man1/servoctl.1.gz ] || fail "man -L zh_CN.UTF-8 -w: $answer"
for file in bash-completion/completions/servoctl zsh/vendor-completions/_servoctl fish/vendor_completions.d/servoctl.fish; do
  [ -s "$root/usr/share/$file" ] || fail "$file is missing"
done
for file in docs/json.md docs/schema/envelope.schema.json README.md README.zh.md copyright; do
  [ -s "$root/usr/share/doc/servoctl/$file" ] || fail "doc/servoctl/$file is missing"
done
if command -v getcap >/dev/null && [ -n "$(getcap "$root/usr/bin/servoctl")" ]; then fail "a capability was set"; fi
removed=$(inside dpkg -P servoctl) || fail "it cannot be removed: $removed"
left=$(find "$root" -xdev -name '*servoctl*' -not -path '*/var/log/*' | head -5)
[ -z "$left" ] || fail "removing it leaves $left"
[ "$failures" -eq 0 ] || exit 1
echo "installed, updated, used and removed in a minimal Debian"
