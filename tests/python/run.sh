#!/usr/bin/env bash
# Checks the Python package: builds the wheel, installs it into a fresh environment, compares its type stubs with the module,
# and runs its tests and its notebook. It reuses what the Rust tests have compiled.
set -euo pipefail
cd "$(dirname "$0")/../.."
exec </dev/null
. tests/install.sh

# Debian packages venv separately.
python3 -c 'import ensurepip' 2>/dev/null || need python3-venv python3-venv
if ! python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
    echo "the Python package needs Python 3.11 or newer" >&2
    exit 1
fi
[ -x target/debug/mindgap-under-test ] || cargo test --workspace --features mindgap-tests/mpi --no-run
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT
quietly() { PIP_DISABLE_PIP_VERSION_CHECK=1 "$@" -q; }

tools=target/python/tools
[ -x $tools/bin/maturin ] || { python3 -m venv $tools && quietly $tools/bin/pip install maturin==1.16.0; }
# The wheel does not bundle the MPI library, which the shared build links.
$tools/bin/maturin build --quiet --profile dev --features as-in-tests --auditwheel skip \
    --manifest-path python/Cargo.toml --out "$fresh/wheels"

python3 -m venv "$fresh/venv"
quietly "$fresh/venv/bin/pip" install "$fresh"/wheels/mindgap-*.whl -r tests/python/requirements.txt
# The package is its native module of the same name, which has no types of its own.
"$fresh/venv/bin/stubtest" mindgap --mypy-config-file tests/python/mypy.ini --allowlist <(echo mindgap.mindgap)
MINDGAP=$PWD/target/debug/mindgap-under-test "$fresh/venv/bin/pytest" -q -p no:cacheprovider tests/python
