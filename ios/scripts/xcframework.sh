#!/bin/sh
# Lays out ios/FieldwalkFFI.xcframework: the engine for iOS devices and simulators, and on a Mac for macOS too.
#
# With Xcode and rustup it is built with them. Elsewhere the static libraries are cross-built without Apple's SDK, which
# they do not need, and the folder is written by hand: by rustup's targets where they are installed, else by Debian's
# rustc-web with its sources (apt-get install rustc-web cargo-web rust-web-src). Without either it says so and exits with 3.
set -eu

cd "$(dirname "$0")/../.."
target_dir=${CARGO_TARGET_DIR:-target}
out=ios/FieldwalkFFI.xcframework
work=$target_dir/bindings/xcframework
header=ios/Sources/FieldwalkFFI/FieldwalkFFI.h

export IPHONEOS_DEPLOYMENT_TARGET=15.0 MACOSX_DEPLOYMENT_TARGET=12.0
# Line tables would make the archive several times larger.
export CARGO_PROFILE_RELEASE_DEBUG=false CARGO_PROFILE_RELEASE_CODEGEN_UNITS=1 CARGO_PROFILE_RELEASE_LTO=fat

if [ ! -f "$header" ]; then
    echo "$header is missing: run cargo xtask bindings first" >&2
    exit 1
fi

device="aarch64-apple-ios"
simulator="aarch64-apple-ios-sim x86_64-apple-ios"
mac="aarch64-apple-darwin x86_64-apple-darwin"

has_target() {
    [ -d "$(rustc --print target-libdir --target "$1" 2>/dev/null)" ]
}

build_with_rustup() {
    cargo rustc --quiet --release --package fieldwalk-ffi --lib --crate-type staticlib --target "$1"
}

build_with_debian() {
    RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1 /usr/bin/cargo rustc --quiet --release --package fieldwalk-ffi --lib \
        --crate-type staticlib --target "$1" -Zbuild-std=std,panic_unwind
}

# The header and module of a slice, in a folder of their own: headers of several frameworks share one when linked.
lay_out_headers() {
    mkdir -p "$1/FieldwalkFFI"
    cp "$header" "$1/FieldwalkFFI/"
    printf 'module FieldwalkFFI {\n    header "FieldwalkFFI.h"\n    export *\n}\n' >"$1/FieldwalkFFI/module.modulemap"
}

library() {
    echo "$target_dir/$1/release/libfieldwalk_ffi.a"
}

rm -rf "$work" "$out"
mkdir -p "$work"

if command -v xcodebuild >/dev/null && command -v rustup >/dev/null; then
    for target in $device $simulator $mac; do
        rustup target add "$target"
        build_with_rustup "$target"
    done
    lay_out_headers "$work/headers"
    mkdir -p "$work/simulator" "$work/mac"
    lipo -create $(for target in $simulator; do library "$target"; done) -output "$work/simulator/libfieldwalk_ffi.a"
    lipo -create $(for target in $mac; do library "$target"; done) -output "$work/mac/libfieldwalk_ffi.a"
    xcodebuild -create-xcframework -output "$out" \
        -library "$(library "$device")" -headers "$work/headers" \
        -library "$work/simulator/libfieldwalk_ffi.a" -headers "$work/headers" \
        -library "$work/mac/libfieldwalk_ffi.a" -headers "$work/headers"
    exit
fi

# Without lipo one architecture a slice: arm64, which all devices and the simulators of today's Macs are.
simulator="aarch64-apple-ios-sim"
if has_target "$device" && has_target "$simulator"; then
    build=build_with_rustup
elif [ -x /usr/bin/cargo ] && [ -d "$(/usr/bin/rustc --print sysroot 2>/dev/null)/lib/rustlib/src/rust/library" ]; then
    build=build_with_debian
else
    echo "SKIPPED: no Rust for iOS here: rustup target add $device $simulator, or on Debian" \
        "apt-get install rustc-web cargo-web rust-web-src" >&2
    exit 3
fi

slice() {
    folder=$out/$1
    $build "$2"
    mkdir -p "$folder"
    cp "$(library "$2")" "$folder/"
    lay_out_headers "$folder/Headers"
}

described() {
    cat <<PLIST
		<dict>
			<key>BinaryPath</key>
			<string>libfieldwalk_ffi.a</string>
			<key>HeadersPath</key>
			<string>Headers</string>
			<key>LibraryIdentifier</key>
			<string>$1</string>
			<key>LibraryPath</key>
			<string>libfieldwalk_ffi.a</string>
			<key>SupportedArchitectures</key>
			<array>
				<string>arm64</string>
			</array>
			<key>SupportedPlatform</key>
			<string>ios</string>$2
		</dict>
PLIST
}

slice ios-arm64 "$device"
slice ios-arm64-simulator "$simulator"
variant='
			<key>SupportedPlatformVariant</key>
			<string>simulator</string>'
{
    echo '<?xml version="1.0" encoding="UTF-8"?>'
    echo '<!DOCTYPE plist PUBLIC "-//Apple//DTD PLIST 1.0//EN" "http://www.apple.com/DTDs/PropertyList-1.0.dtd">'
    echo '<plist version="1.0">'
    echo '<dict>'
    printf '\t<key>AvailableLibraries</key>\n\t<array>\n'
    described ios-arm64 ""
    described ios-arm64-simulator "$variant"
    printf '\t</array>\n\t<key>CFBundlePackageType</key>\n\t<string>XFWK</string>\n'
    printf '\t<key>XCFrameworkFormatVersion</key>\n\t<string>1.0</string>\n'
    echo '</dict>'
    echo '</plist>'
} >"$out/Info.plist"
du -sh "$out"/*
