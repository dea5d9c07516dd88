"""The command line as ``python -m microswim``, where its script is not on the path."""

from microswim.cli import main

if __name__ == "__main__":
    main()
