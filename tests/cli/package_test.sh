#!/usr/bin/env bash
# Packs what was built, and tries it: the .deb unpacked, the tarball at another place, `cmake --install`.
# tests/real/clean_root_test.sh installs the .deb where there is nothing but what it depends on.
# usage: package_test.sh SERVOCTL BUILD_DIR
set -euo pipefail
build=$(readlink -f "$2")
for tool in dpkg-deb dpkg-shlibdeps cpack; do
  command -v "$tool" >/dev/null || { echo "$tool is missing: ./dev deps installs it"; exit 77; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
fail() { echo "FAILED $*"; failures=$((failures + 1)); }

cd "$work"
cpack --config "$build/CPackConfig.cmake" -B "$work/packed" >log 2>&1 || { cat log; exit 1; }
deb=$(echo packed/*.deb)
version=$(head -1 "$build/version/version.txt")

# What an installed program finds of its own, with nothing of ours around it.
works() {  # works NAME PROGRAM
  local answer
  answer=$(cd / && env -i "$2" --version 2>&1) || true
  [ "$answer" = "servoctl $version" ] || fail "$1: --version says $answer"
  answer=$(cd / && env -i "$2" drives 2>&1) || true
  grep -q '^gsd600' <<<"$answer" || fail "$1: drives says $answer"
  answer=$(cd / && env -i "$2" scan -b sim:gsd600@1 2>&1) || true
  grep -q '^ *1 .*gsd600' <<<"$answer" || fail "$1: scan says $answer"
}
has() {  # has NAME FOLDER FILE…
  local file
  for file in "${@:3}"; do [ -s "$2/$file" ] || fail "$1: $file is missing"; done
}
common=(share/bash-completion/completions/servoctl share/fish/vendor_completions.d/servoctl.fish share/man/man1/servoctl.1.gz share/man/zh_CN/man1/servoctl.1.gz
  share/doc/servoctl/README.md share/doc/servoctl/copyright share/doc/servoctl/changelog.gz share/doc/servoctl/docs/motion.md
  share/doc/servoctl/docs/schema/envelope.schema.json share/doc/servoctl/docs/schema/backup-file.schema.json share/doc/servoctl/README.zh.md
  share/doc/servoctl/examples/first-contact.servoctl share/servoctl/eds/cia/cia402.eds lib/udev/rules.d/60-servoctl.rules)

mkdir root control
dpkg-deb -x "$deb" root
dpkg-deb -e "$deb" control
[ "$(dpkg-deb -f "$deb" Version)" = "$version-1" ] || fail "the .deb is $(dpkg-deb -f "$deb" Version), the program $version"
depends=$(dpkg-deb -f "$deb" Depends)
for library in libboost-context libc6 libnl-3 libpugixml libstdc++6 zlib1g; do
  grep -q "$library" <<<"$depends" || fail "the .deb does not depend on $library: $depends"
done
has .deb root/usr "${common[@]}" share/zsh/vendor-completions/_servoctl share/doc/servoctl/README.Debian share/doc/servoctl/changelog.Debian.gz
works .deb "$work/root/usr/bin/servoctl"
gzip -dc root/usr/share/man/man1/servoctl.1.gz | cmp -s - <(root/usr/bin/servoctl man) || fail "the manual page is not that of the program"
gzip -dc root/usr/share/man/zh_CN/man1/servoctl.1.gz | cmp -s - <(root/usr/bin/servoctl man --lang zh) || fail "nor is the Chinese one"
for library in libboost libcli11 libfmt nlohmann-json3 libexpected libtomlplusplus; do
  grep -q "^$library.*-dev (source: [^ ]* [^ ]*)$" root/usr/share/doc/servoctl/copyright || fail "no licence of $library"
done
while IFS= read -r terms; do
  [ -e "$terms" ] || fail "$terms is not there"
done < <(grep -oE '/usr/share/common-licenses/[A-Za-z0-9.-]*[A-Za-z0-9]' root/usr/share/doc/servoctl/copyright | sort -u)
# The right is told, not set: it is not run unless it only prints.
if grep -vE '^ *(#|echo )' control/postinst | grep -E '[a-z]*cap|chmod|chown|usermod|adduser'; then
  fail "postinst changes rights"
else
  told=$(sh control/postinst configure)
  [[ $told == *'setcap cap_net_raw+ep /usr/bin/servoctl'* ]] || fail "postinst does not tell the capability: $told"
  [[ $(sh control/postinst configure 0.0.1) == *'are gone'* ]] || fail "postinst does not tell that an update takes it away"
fi
if command -v lintian >/dev/null; then
  lintian --fail-on error --tag-display-limit 0 "$deb" >lintian.txt 2>&1 || fail "lintian: $(grep '^E:' lintian.txt)"
fi

mkdir -p 'an other place/ü'
tar -xzf packed/*.tar.gz -C 'an other place/ü' --strip-components=1
has tarball "$work/an other place/ü" "${common[@]}" share/zsh/site-functions/_servoctl share/doc/servoctl/licenses/LGPL-2.1
for library in libboost libcli11 libfmt nlohmann-json3 libexpected libtomlplusplus libpugixml libnl-3 zlib1g libstdc++ libc6; do
  grep -q "^$library.*-dev (source: [^ ]* [^ ]*)$" 'an other place/ü/share/doc/servoctl/copyright' || fail "no licence of $library in the tarball"
done
works tarball "$work/an other place/ü/bin/servoctl"
ln -s 'an other place/ü/bin/servoctl' linked
works 'link to the tarball' "$work/linked"

cmake --install "$build" --prefix "$work/pre fix" >log 2>&1 || { cat log; exit 1; }
has install "$work/pre fix" "${common[@]}" share/zsh/site-functions/_servoctl
works install "$work/pre fix/bin/servoctl"

[ "$failures" -eq 0 ] || exit 1
ls -sh packed/*.deb packed/*.tar.gz
