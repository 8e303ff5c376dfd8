#!/usr/bin/env bash
# build.sh [PAGE]: makes the page that checks and diagnoses logs in a browser, one HTML file (default:
# target/browser/mindgap.html), and prints its size. Installs what is missing on Debian and Ubuntu.
set -euo pipefail
page=$(realpath -m "${1:-$(dirname "$0")/../../target/browser/mindgap.html}")
cd "$(dirname "$0")/../.."
. tests/install.sh

TARGET=wasm32-unknown-unknown
MAX_BYTES=1600000 # of the page, compressed

if rustup target add "$TARGET" >/dev/null 2>&1; then
    cross=(cargo) std=()
else
    choose_compiler
    std=(-Zbuild-std=std,panic_abort)
fi
# Libraries in C that unpack bags; gcc has no WebAssembly.
need clang clang
need node nodejs
"${cross[@]}" build --quiet --profile wasm -p mindgap-browser --lib --target "$TARGET" "${std[@]}"
mkdir -p "$(dirname "$page")"
node host-sim/browser/assemble.mjs "target/$TARGET/wasm/mindgap_browser.wasm" "$page"
bytes=$(gzip -9c "$page" | wc -c)
echo "$page: $(wc -c <"$page") bytes, $bytes compressed"
((bytes <= MAX_BYTES)) || { echo "the page is larger than $MAX_BYTES bytes compressed" >&2; exit 1; }
