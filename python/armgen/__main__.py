"""`python -m armgen` is the program armgen."""

from armgen._program import main

main()
