"""Answers of today beside those that are kept."""

import csv

from . import questions


def test_answers_are_those_that_are_kept():
    with questions.ANSWERS.open(encoding="utf-8", newline="") as file:
        kept = {row["question"]: row for row in csv.DictReader(file)}
    found = {what: (answer, margin) for what, answer, margin in questions.answers()}
    assert found.keys() == kept.keys()
    moved = {
        what: f"{kept[what]['answer']} kept, {answer!r} found"
        for what, (answer, margin) in found.items()
        if not abs(answer - float(kept[what]["answer"])) <= margin + float(kept[what]["margin"])
    }
    assert not moved
