"""Answers that an object remembers, and that go when it goes.

`lru_cache` of a bound method ties a knot: the object holds the cache, and the cache the object.
Both then stay until Python next looks for waste, which takes long where much is in memory.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

Method = TypeVar("Method", bound=Callable[..., Any])


def cached_method(most: int) -> Callable[[Method], Method]:
    """Of a method, by its positional arguments; most: answers kept, the oldest are forgotten."""

    def of(method: Method) -> Method:
        name = f"{method.__name__} remembered"

        @wraps(method)
        def ask(self: Any, *question: Any) -> Any:
            known = self.__dict__.setdefault(name, {})
            if question in known:
                return known[question]
            answer = method(self, *question)
            if len(known) >= most:
                known.pop(next(iter(known)), None)
            known[question] = answer
            return answer

        return cast(Method, ask)

    return of
