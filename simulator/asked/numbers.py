"""Numbers that commands are given beside a scene."""

from __future__ import annotations


def check_numbers(
    *, draws: int = 2, against_rest: int = 0, seed: int = 0, n: int | None = None
) -> None:
    """Raises InputError where one is out of range."""
    from ..sweeps import InputError

    for name, value, least, most in (
        ("--draws", draws, 2, 10**6),
        ("--against-rest", against_rest, 0, 10**6),
        ("--seed", seed, 0, 2**63),
        ("-n", 1 if n is None else n, 1, 100),
    ):
        if not least <= value <= most:
            raise InputError(f"{name} must be from {least} to {most}, got {value}")
