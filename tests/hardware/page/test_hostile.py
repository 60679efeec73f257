"""A served page under hostile clients and fuzzed messages: it stays up, the skin untouched."""

import numpy as np
from rcskin.benchmarks.live import hostile_clients as hostile

CLIENTS, MESSAGES = 150, 400


def test_it_stays_up_and_the_skin_untouched(served, frame, said):
    async def act(page):
        random = np.random.default_rng(3)
        async with page.viewer() as viewer:
            page.post(why="before")
            await frame(viewer)
            await hostile.besieged(page.target, CLIENTS, random)
            await hostile.fuzzed(page.target, MESSAGES, random)
            untouched = list(page.pressed)
            page.post(why="after")
            shown = await frame(viewer)
            answer = await said(viewer, {"do": "press", "press": "1,1"})
        async with page.viewer() as newcomer:
            return untouched, shown, answer, await frame(newcomer)

    untouched, shown, answer, anew = served(act)
    assert untouched == []
    assert shown["state"] == anew["state"] == {"why": "after"}
    assert answer["do"] == "pressed"
