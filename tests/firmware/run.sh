#!/usr/bin/env bash
# Builds the images for four processors, runs them in QEMU and compares their output with the host, bit for bit. Then it
# checks that no panic is reachable, and how much flash, stack and time the five networks and the controller need. It
# installs missing tools, and exits with 1 and a one-line reason if a check fails.
set -euo pipefail
cd "$(dirname "$0")"
. ../install.sh

TARGETS=(thumbv6m-none-eabi thumbv7em-none-eabi armv4t-none-eabi thumbv4t-none-eabi)
MAX_FLASH=12288 # bytes of the image `bare`: code, five networks, one controller
MAX_STACK=1023  # bytes
MAX_MONITOR_FLASH=4096 # bytes of code and constants of the monitor without networks: `bare_monitor` without the same image without it
DEFMT_PRINT=1.2.0
logs=$(mktemp -d)
trap 'rm -rf "$logs"' EXIT

# Largest number of instructions of all five networks together.
max_instructions() {
  case $1 in
  thumbv7em-*) echo 4000 ;;
  armv4t-*) echo 7000 ;;
  *) echo 16000 ;;
  esac
}

# Largest number of instructions of a step of the monitor, without the networks.
MAX_MONITOR_INSTRUCTIONS=1500

main() {
  install_tools
  choose_compiler
  # Debug checks are on here, so that an overflow on the host would end the job.
  cargo run --quiet --bin job >"$logs/host.txt"
  for target in "${TARGETS[@]}"; do
    check "$target"
  done
  check_example
}

check() {
  local target=$1 folder=target/$1/release
  # One target at a time: otherwise cargo would enable the features of any target for all of them.
  build --target "$target" --bins || fail "$target: does not build, or a panic is reachable (see above)"
  emulate "$target" "$folder/job" >"$logs/raw" || fail "$target: the job ended with $?"
  text "$target" "$folder/job" <"$logs/raw" >"$logs/all.txt"
  grep -v '^measured:' "$logs/all.txt" >"$logs/target.txt" || fail "$target: printed nothing"
  diff "$logs/host.txt" "$logs/target.txt" || fail "$target: prints something other than the host (<)"

  local stack flash instructions
  stack=$(sed -n 's/^measured: stack \([0-9]*\) bytes$/\1/p' "$logs/all.txt")
  flash=$(size "$folder/bare" | awk 'NR == 2 { print $1 + $2 }')
  instructions=$(max_counted "$target" "$folder/bare")
  echo "$target: $(wc -l <"$logs/host.txt") lines equal the host's; $flash bytes of flash, $stack bytes of stack," \
    "at most $instructions instructions for all five networks"
  ((stack > 0 && stack <= MAX_STACK)) || fail "$target: needs more than $MAX_STACK bytes of stack"
  ((flash > 0 && flash <= MAX_FLASH)) || fail "$target: needs more than $MAX_FLASH bytes of flash"
  ((instructions > 0 && instructions <= $(max_instructions "$target"))) ||
    fail "$target: needs more than $(max_instructions "$target") instructions"

  [[ $target != thumbv6m-* ]] || check_monitor "$target" "$folder/bare_monitor"

  # The check for panics must be able to fail.
  if build --target "$target" --bin panic_free --features reachable-panic 2>"$logs/panic.txt"; then
    fail "$target: links although a panic is reachable"
  fi
  grep -q a_panic_is_reachable "$logs/panic.txt" || fail "$target: the image with a panic fails for another reason"
}

# Measures the monitor on the smallest processor.
check_monitor() {
  local target=$1 image=$2 flash rest instructions
  flash=$(size "$image" | awk 'NR == 2 { print $1 + $2 }')
  instructions=$(max_counted "$target" "$image")
  build --target "$target" --bin bare_monitor --features without-monitor || fail "$target: does not build without the monitor"
  rest=$(size "$image" | awk 'NR == 2 { print $1 + $2 }')
  flash=$((flash - rest))
  echo "$target: the monitor takes $flash bytes of flash, at most $instructions instructions per step"
  ((flash > 0 && flash <= MAX_MONITOR_FLASH)) || fail "$target: the monitor needs more than $MAX_MONITOR_FLASH bytes"
  ((instructions > 0 && instructions <= MAX_MONITOR_INSTRUCTIONS)) ||
    fail "$target: the monitor needs more than $MAX_MONITOR_INSTRUCTIONS instructions"
}

# Builds the example project and runs it on a board of QEMU.
check_example() {
  local target=thumbv7em-none-eabi here=$PWD
  (cd ../../core/examples/rtic && build --target "$target" --target-dir "$here/target") ||
    fail "core/examples/rtic: does not build"
  emulate "$target" "target/$target/release/mindgap-rtic-example" >"$logs/example.txt" ||
    fail "core/examples/rtic: ended with $?"
  [ "$(tail -1 "$logs/example.txt")" = Finished ] || fail "core/examples/rtic: the controller did not finish"
  echo "core/examples/rtic: the controller finished"
}

build() {
  "${cross[@]}" build --quiet --release -Zbuild-std=core "$@"
}

emulate() {
  local target=$1 image=$2
  shift 2
  case $target in
  thumbv6m-*) emulate_board microbit "$image" "$@" ;;
  thumbv7em-*) emulate_board mps2-an386 "$image" "$@" ;;
  *) timeout 300 qemu-arm -cpu ti925t "$@" "$image" ;;
  esac
}

emulate_board() {
  local machine=$1 image=$2
  shift 2
  timeout 300 qemu-system-arm -machine "$machine" -kernel "$image" -display none -monitor none -serial none \
    -semihosting-config enable=on,target=native "$@" </dev/null
}

# Decodes the output of an image: frames of defmt on Cortex-M, plain text on ARM7.
text() {
  case $1 in
  *v4t-*) cat ;;
  *) target/tools/bin/defmt-print -e "$2" --log-format '{s}' ;;
  esac
}

# Prints the largest number of instructions between the two marks of the image `bare`.
max_counted() {
  local target=$1 image=$2 each from to
  case $target in
  *v4t-*) each=$(one_by_one qemu-arm -one-insn-per-tb) ;;
  *) each=$(one_by_one qemu-system-arm "-accel tcg,one-insn-per-tb=on") ;;
  esac
  # shellcheck disable=SC2086 # $each may be two words.
  emulate "$target" "$image" $each -d exec,nochain -D "$logs/trace"
  from=$(address "$image" count_from_here)
  to=$(address "$image" count_to_here)
  awk -F'[][/]' -v from="$from" -v to="$to" '
    # As text: 00000e10 and 00000e20 are the same number.
    /^Trace/ && $3 "" == from "" { counts = 1; n = 0 }
    /^Trace/ && $3 "" == to "" { counts = 0; if (n > max) max = n }
    /^Trace/ && counts { n++ }
    END { print max + 0 }' "$logs/trace"
}

# Prints the option that makes this version of QEMU translate one instruction at a time.
one_by_one() {
  if "$1" -help | grep -q -- -singlestep; then echo -singlestep; else echo "$2"; fi
}

# Prints a symbol's address in the format of QEMU's traces, without the mark of a Thumb function.
address() {
  printf '%08x' $((0x$(nm "$1" | awk -v name="$2" '$3 == name { print $1 }') & ~1))
}

install_tools() {
  need qemu-arm qemu-user
  need qemu-system-arm qemu-system-arm
  need nm binutils
  if ! target/tools/bin/defmt-print --version 2>/dev/null | grep -q "$DEFMT_PRINT"; then
    # Without optimisation it builds in half the time, and it has little to do.
    CARGO_PROFILE_DEV_DEBUG=false cargo install --quiet --locked --debug --root target/tools --version "$DEFMT_PRINT" defmt-print 2>"$logs/tools.txt" ||
      fail "defmt-print cannot be installed: $(tail -1 "$logs/tools.txt")"
  fi
}

fail() {
  echo "$1" >&2
  exit 1
}

main
