"""Cache of a method's results that lives in the object itself.

`lru_cache` of a bound method makes a reference cycle: the object holds the cache and the cache
holds the object. Both then stay until the next garbage collection, which is slow with much memory
in use.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

Method = TypeVar("Method", bound=Callable[..., Any])


def cached_method(max_entries: int) -> Callable[[Method], Method]:
    """Decorator that caches the latest `max_entries` results by positional arguments."""

    def decorate(method: Method) -> Method:
        name = f"{method.__name__} cached"

        @wraps(method)
        def call(self: Any, *arguments: Any) -> Any:
            known = self.__dict__.setdefault(name, {})
            if arguments in known:
                return known[arguments]
            result = method(self, *arguments)
            if len(known) >= max_entries:
                known.pop(next(iter(known)), None)
            known[arguments] = result
            return result

        return cast(Method, call)

    return decorate
