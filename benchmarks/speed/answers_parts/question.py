"""A question with the ways to answer it: how far off each is, and how long it takes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import pandas as pd
from rcskin.benchmarks.bench import Run


class Answer(NamedTuple):
    """Of a way at one setting. error: as the question means it. seconds: to the answer."""

    way: str
    setting: str
    error: float
    seconds: float


@dataclass(frozen=True)
class Question:
    """What is asked. error, time: what the axes mean. ours: ways of this project. wrong: an error
    that makes an answer useless. stalls: whether a way that gains little by more work is told to
    stall. pick: which way to take when, in a sentence."""

    title: str
    error: str
    time: str
    ours: tuple[str, ...]
    answers: Callable[[Run], Iterator[Answer]]
    pick: str
    wrong: float = 0.1
    stalls: bool = True

    def measured(self, run: Run) -> pd.DataFrame:
        """All answers, printed as they come."""
        found = []
        for answer in self.answers(run):
            print(f"{self.title}: {answer}", flush=True)
            found.append(answer)
        return pd.DataFrame(found, columns=list(Answer._fields))
