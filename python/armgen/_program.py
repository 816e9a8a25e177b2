"""The program armgen."""

from __future__ import annotations

import signal
import sys


def main() -> None:
    from . import _native  # type: ignore[attr-defined]

    # Interrupts end the program, as they end others; Python would only note them until the command returns.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_native.run(["armgen", *sys.argv[1:]]))
