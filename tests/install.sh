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

# need_axe: the accessibility checker that the tests of pages load into the browser, of one version.
need_axe() {
    if [ -e target/npm/node_modules/axe-core/axe.min.js ]; then return; fi
    echo "installing axe-core" >&2
    if ! npm install --silent --no-save --prefix target/npm axe-core@4.14.1 >/dev/null 2>&1; then
        echo "axe-core is missing: npm install --prefix target/npm axe-core@4.14.1" >&2
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
