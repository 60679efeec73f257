"""Files with a flipped bit or cut short: refused in one line, or read to the same."""

import numpy as np
from rcskin.simulator.sweeps import InputError


def share_refused(path, reader, same, flips, cuts=0):
    """Of so many copies of a file, or of those in a folder in turn, each spoilt in one way.

    reader: of the path. same: whether what it reads is what stood there, as it must where a copy
    is not refused.
    """
    refused = [_refused(path, reader, same) for _ in spoilt(path, flips, cuts)]
    return np.mean(refused)


def spoilt(path, flips, cuts):
    """Spoils a file, or those in a folder in turn, in one way after the other."""
    random = np.random.default_rng(0)
    files = [path] if path.is_file() else sorted(each for each in path.rglob("*") if each.is_file())
    for number in range(flips + cuts):
        file = files[number % len(files)]
        whole = file.read_bytes()
        bit = int(random.integers(8 * len(whole)))
        part = bytearray(whole if number < flips else whole[: bit // 8])
        if number < flips:
            part[bit // 8] ^= 1 << bit % 8
        file.write_bytes(part)
        yield
        file.write_bytes(whole)


def _refused(path, reader, same):
    try:
        again = reader(path)
    except InputError as error:
        assert str(error).startswith(str(path)) and "\n" not in str(error)
        return True
    assert same(again)
    return False
