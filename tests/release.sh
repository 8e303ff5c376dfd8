#!/usr/bin/env bash
# Checks before a release: the published crates are packaged and built from their packages, and their public interfaces are
# compared with the last release tag (semantic versioning). Installs cargo-semver-checks if it is missing. The working tree
# has to be clean.
set -euo pipefail
cd "$(dirname "$0")/.."

CRATES=(-p mindgap-core -p mindgap-controller-export)
log=$(mktemp)
trap 'rm -f "$log"' EXIT

cargo package "${CRATES[@]}" 2>&1 | tee "$log"
if grep -q '^warning' "$log"; then
    echo "cargo package warns: see above" >&2
    exit 1
fi

tag=$(git describe --tags --abbrev=0 --match '[0-9]*.[0-9]*.[0-9]*' 2>/dev/null || true)
if [ -z "$tag" ]; then
    echo "there is no release tag to compare the public interfaces with"
    exit
fi
cargo semver-checks --version >/dev/null 2>&1 || cargo install --locked cargo-semver-checks
cargo semver-checks "${CRATES[@]}" --baseline-rev "$tag"
