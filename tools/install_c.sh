#!/bin/sh
# Builds the C interface and installs library, headers and pkg-config file: tools/install_c.sh [PREFIX], /usr/local
# without one. DESTDIR stands before the folder, for packages.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
prefix=${1:-/usr/local}
into=${DESTDIR:-}$prefix
cd "$root"
cargo build --release --quiet -p contactsense-capi
built=${CARGO_TARGET_DIR:-target}/release
version=$(sed -n 's/^version = "\(.*\)"$/\1/p' Cargo.toml | head -n 1)
# What the standard library of Rust needs of the system.
case $(uname -s) in
Darwin) shared=libcontactsense_c.dylib system="-lSystem -lm" ;;
*) shared=libcontactsense_c.so system="-lpthread -ldl -lm" ;;
esac
mkdir -p "$into/lib/pkgconfig" "$into/include"
cp "$built/$shared" "$built/libcontactsense_c.a" "$into/lib/"
cp rust/capi/include/contactsense.h rust/capi/include/contactsense.hpp "$into/include/"
sed -e "s|@PREFIX@|$prefix|" -e "s|@VERSION@|$version|" -e "s|@SYSTEM@|$system|" rust/capi/contactsense.pc.in \
    > "$into/lib/pkgconfig/contactsense.pc"
