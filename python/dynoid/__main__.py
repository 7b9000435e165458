"""The program `dynoid`."""

import sys

from ._dynoid import program


def main() -> None:
    """Runs the program with the arguments of this process."""
    sys.exit(program(["dynoid", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
