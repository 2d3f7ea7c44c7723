#!/bin/sh
# Stops with a message where cargo is missing or older than the workspace's rust-version.
wanted=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
found=$(cargo --version 2>/dev/null | awk '{print $2}')
if [ -z "$found" ]; then
    echo "contactsense needs Rust $wanted or newer (cargo was not found); see https://rustup.rs" >&2
    exit 1
fi
oldest=$(printf '%s\n%s\n' "$wanted" "$found" | sort -V | head -n 1)
if [ "$oldest" != "$wanted" ]; then
    echo "contactsense needs Rust $wanted or newer (found: $found); see https://rustup.rs" >&2
    exit 1
fi
