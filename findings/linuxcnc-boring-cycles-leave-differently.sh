#!/usr/bin/env bash
# LinuxCNC 2.9.0~pre1 (Debian 12), interpreter rs274: the boring cycles G85 and G89 leave the hole differently under G98.
#
# Both feed to Z and back (G89 waits there). Driven to Z = -3 from Z = 5 with R = 2, under G98, G85 feeds back to R and
# goes on rapidly to where the cycle began; G89 feeds all the way to where it began. Under G99 both feed to R. Without
# G98 or G99 in the program the interpreter comes back to R (as G99), where other controls start with G98. Whoever takes
# loads or times of a robot's boring cycle from such a program has to know which part of the way out is a move at feed.
#
# Seen, in mm:
#   G98 G85: feed -3, feed 2, rapid 5      G98 G89: feed -3, feed 5      neither, G81: feed -3, rapid 2
#
# Needs Debian 12 and apt-get; installs nothing: packages are unpacked in a temporary folder.
set -euo pipefail

version='2.9.0~pre1+git20230208.f1270d6ed7-1+deb12u2'
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get download -qq "linuxcnc-uspace=$version" libboost-python1.74.0=1.74.0+ds1-21 libpython3.11 libpython3.11-stdlib \
    libpython3.11-minimal python3.11-minimal libedit2 libbsd0 libmd0 libtirpc3 >apt.log 2>&1 || { cat apt.log; exit 2; }
for package in ./*.deb; do dpkg-deb -x "$package" root; done
export LD_LIBRARY_PATH="$folder/root/lib:$folder/root/usr/lib:$folder/root/lib/x86_64-linux-gnu:$folder/root/usr/lib/x86_64-linux-gnu"
export PYTHONHOME="$folder/root/usr"

# The moves behind the start, with their z.
driven() {
    printf 'G21 G90 G17\nG0 X0 Y0 Z5\n%s\nG80\nM2\n' "$1" >part.ngc
    "$folder/root/usr/bin/rs274" -g part.ngc 2>errors.txt |
        sed -nE 's/.*STRAIGHT_(FEED|TRAVERSE)\([^,]*, [^,]*, (-?[0-9]+)\..*/\1 \2/p' | tail -n +3 | uniq | tr '\n' ',' || true
}

check() {
    local seen
    seen=$(driven "$1")
    echo "$1: $seen"
    if [ "$seen" != "$2" ]; then
        echo "changed: expected $2"
        cat errors.txt
        exit 1
    fi
}

check 'G98 G85 X0 Y0 Z-3 R2 F100' 'TRAVERSE 2,FEED -3,FEED 2,TRAVERSE 5,'
check 'G98 G89 X0 Y0 Z-3 R2 P0.1 F100' 'TRAVERSE 2,FEED -3,FEED 5,'
check 'G81 X0 Y0 Z-3 R2 F100' 'TRAVERSE 2,FEED -3,TRAVERSE 2,'
echo "ok: rs274 $version leaves G85 in two moves and G89 in one under G98, and comes back to R where neither is stated"
