# Taken in by the scripts of tests that need more than Rust.
#
#   say_skipped CHECK REASON   says that something of a check is left out, in the file that ARMGEN_SKIPPED names as well
#   leave_out CHECK REASON     the same of what is not installed: a failure where ARMGEN_REQUIRE_TOOLS is set
#   skip CHECK REASON          the same of a whole script, which ends
#
# Tests in Rust have tests/src/installed.rs.

say_skipped() {
    echo "$1: SKIPPED: $2"
    [ -z "${ARMGEN_SKIPPED:-}" ] || echo "$1: $2" >> "$ARMGEN_SKIPPED"
}

leave_out() {
    say_skipped "$1" "$2"
    if [ -n "${ARMGEN_REQUIRE_TOOLS:-}" ]; then
        echo "$1: ARMGEN_REQUIRE_TOOLS is set, and $2" >&2
        exit 1
    fi
}

skip() {
    leave_out "$1" "$2"
    exit 0
}
