"""The front door: the `rcskin` command, wiring simulator, localization and hardware together."""


def main() -> None:
    """Run the command line."""
