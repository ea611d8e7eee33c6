"""`python -m cutcell` is the same as `cutcell`."""

from .cli.app import main

if __name__ == "__main__":
    main()
