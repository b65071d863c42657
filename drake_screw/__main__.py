"""``python -m drake_screw`` is the ``drake-screw`` command."""

from drake_screw.cli import main

if __name__ == "__main__":
    main()
