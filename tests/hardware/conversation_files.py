"""Files of conversations with instruments, written from manuals: lines sent and lines answered."""

from pathlib import Path

CONVERSATIONS = Path(__file__).with_name("conversations")


def spoken(path):
    """(line sent, line answered or None) of a conversation; other lines are remarks."""
    turns = []
    for line in path.read_text(encoding="ascii").splitlines():
        mark, _, text = line.partition(" ")
        if mark == ">":
            turns.append((text, None))
        elif mark == "<":
            turns[-1] = (turns[-1][0], text)
    return turns
