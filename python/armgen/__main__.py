"""`python -m armgen` is the program armgen."""

from armgen._program import main

if __name__ == "__main__":
    main()
