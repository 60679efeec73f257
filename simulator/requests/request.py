"""One class for each command: what is given, its checks, and what is done.

The command line, the public function of the same name, their help and the pages of the reference
are made from it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, FrozenInstanceError, dataclass, field, fields
from inspect import Parameter, Signature, cleandoc
from textwrap import fill
from typing import (
    Any,
    ClassVar,
    NamedTuple,
    ParamSpec,
    Protocol,
    Self,
    TypeVar,
    dataclass_transform,
)

from .argument_types import check_type, refuse
from .number_ranges import ANY, AllowedRange, check_number

Given = ParamSpec("Given")
Answer = TypeVar("Answer", covariant=True)


class How(NamedTuple):
    """How an argument is given; several requests may share one.

    help: sentences for the command line and for Python. flags: what is typed, by default `--name`;
    of an argument without an option its name in the help. within: the allowed numbers. among: the
    allowed texts. complete: values that the shell completes, by default `among`. kind: type on the
    command line, by default that of KINDS. called: sentences for Python where a value has another
    form there.
    """

    help: str
    flags: tuple[str, ...] = ()
    within: AllowedRange = ANY
    among: tuple[str, ...] = ()
    complete: Callable[..., list[str]] | None = None
    kind: Any = None
    called: str = ""


class Way(NamedTuple):
    """Where an argument is given, and how.

    typed: False if the command line lacks it. placed: True for an argument without an option.
    typed_default: default of the command line, `...` if it must be given; MISSING: the class's.
    """

    how: How
    typed: bool = True
    placed: bool = False
    typed_default: Any = MISSING


def _field(
    help: str | How,
    flags: tuple[str, ...],
    more: Mapping[str, Any],
    *,
    default: Any,
    init: bool = True,
    kw_only: bool = False,
    **where: Any,
) -> Any:
    shared = help if isinstance(help, How) else How(help)
    how = shared._replace(**({"flags": flags} if flags else {}), **more)
    metadata = {"way": Way(how, **where)}
    return field(default=default, init=init, kw_only=kw_only, metadata=metadata)


def argument(help: str | How, *flags: str, default: Any = MISSING, **more: Any) -> Any:
    """Field of an argument that is given by its place. more: see `How`."""
    return _field(help, flags, more, default=default, placed=True)


def option(
    help: str | How,
    *flags: str,
    default: Any = MISSING,
    typed_default: Any = MISSING,
    kw_only: bool = True,
    **more: Any,
) -> Any:
    """Field of an option, in Python an argument. more: see `How`.

    typed_default: default of the command line if it is another one; `...`: it must be given.
    """
    return _field(help, flags, more, default=default, kw_only=kw_only, typed_default=typed_default)


def typed(
    help: str | How,
    *flags: str,
    default: Any = MISSING,
    placed: bool = False,
    init: bool = False,
    **more: Any,
) -> Any:
    """Field of what only the command line has, by an option or by its place. more: see `How`."""
    return _field(help, flags, more, default=default, init=init, placed=placed)


def called(help: str, *, default: Any = MISSING, kw_only: bool = False, **more: Any) -> Any:
    """Field of an argument that only Python has. more: see `How`."""
    return _field(help, (), more, default=default, kw_only=kw_only, typed=False)


@dataclass_transform(frozen_default=True, field_specifiers=(argument, option, typed, called))
class Request:
    """What one command is given. Subclasses are frozen dataclasses of the fields above.

    `run` does what the command does, and returns an exit code if it is not 0; the docstring of the
    class is the command's help. `result` does what the public function does, and has its docstring.
    Raises InputError, in one line with the argument's name, the value and what is allowed.
    """

    command_name: ClassVar[str]
    example: ClassVar[str]
    """What is typed after `rcskin `, or empty."""
    __signature__: ClassVar[Signature]

    def __init_subclass__(cls, command: str = "", example: str = "") -> None:
        words = re.findall("[A-Z][a-z]*", cls.__name__)
        cls.command_name, cls.example = command or "-".join(words).lower(), example
        # init and frozen would compile three functions a class, which delays every command
        dataclass(init=False, eq=False, repr=False, match_args=False)(cls)
        cls.__signature__ = _signature(cls)

    def __init__(self, *given: Any, **by_name: Any) -> None:
        try:
            bound = self.__signature__.bind(*given, **by_name)
        except TypeError as error:
            raise TypeError(f"{self.command_name.replace('-', '_')}() {error}") from None
        bound.apply_defaults()
        self.check(bound.arguments)
        self.__dict__.update(bound.arguments)

    def __setattr__(self, name: str, value: object) -> None:
        raise FrozenInstanceError(f"cannot assign to field {name!r}")

    @classmethod
    def check(cls, given: Mapping[str, Any]) -> None:
        """Raises InputError for the first value of another type, or outside its range."""
        for each in fields_of(cls):
            if each.name in given:
                value, how = given[each.name], way(each).how
                check_type(each.name, value, str(each.type))
                check_number(each.name, value, how.within)
                if how.among and value is not None and value not in how.among:
                    refuse(each.name, f"one of {', '.join(how.among)}", value)

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> Self:
        """The request of what was typed, by the names of the fields. Raises InputError."""
        kept = {name: value for name, value in given.items() if value is not None}
        cls.check(kept)
        request = object.__new__(cls)
        for each in fields_of(cls):
            absent = None if "None" in str(each.type) and each.name in given else each.default
            request.__dict__[each.name] = kept.get(each.name, absent)
        return request


def fields_of(request: type[Request]) -> list[Field[Any]]:
    """The fields of a request, those that it inherits last."""
    kind: Any = request
    every = {each.name: each for each in fields(kind)}
    ordered = dict.fromkeys(name for kind in request.__mro__ for name in _declared(kind))
    return [every[name] for name in ordered if name in every]


def _declared(kind: type) -> dict[str, Any]:
    return vars(kind).get("__annotations__", {})


def way(given: Field[Any]) -> Way:
    """Where and how a field is given."""
    return given.metadata["way"]


def _signature(request: type[Request]) -> Signature:
    """The signature in Python."""
    own = [each for each in fields_of(request) if each.init]
    return Signature(
        [
            Parameter(
                each.name,
                Parameter.KEYWORD_ONLY if each.kw_only else Parameter.POSITIONAL_OR_KEYWORD,
                default=Parameter.empty if each.default is MISSING else each.default,
                annotation=each.type,
            )
            for each in sorted(own, key=lambda each: bool(each.kw_only))
        ]
    )


OVERWRITE = How("Replace files and folders that exist.", called="True replaces a file that exists.")


class Writing(Request):
    """A command that writes files or folders, and replaces those that exist on demand only."""

    overwrite: bool = typed(OVERWRITE, default=False)
    overwrite_measured: bool = typed(
        "Replace even measured sweeps, and damaged files that may hold some.", default=False
    )


class Answering(Protocol[Answer]):
    """A request that Python may make."""

    def result(self) -> Answer:
        """What the public function returns."""
        ...


def function(request: Callable[Given, Answering[Answer]]) -> Callable[Given, Answer]:
    """The public function of a request, with its signature and its help."""

    def call(*given: Given.args, **by_name: Given.kwargs) -> Answer:
        return request(*given, **by_name).result()

    kind: Any = request
    signature = kind.__signature__
    hows = {each.name: way(each).how for each in fields_of(kind)}
    arguments = [
        fill(f"{name}: {hows[name].called or hows[name].help}", 96, subsequent_indent="    ")
        for name in signature.parameters
    ]
    said = paragraphs(kind.result)
    errors = said.pop() if said[-1].startswith("Raises ") else ""
    call.__module__ = kind.__module__
    call.__name__ = call.__qualname__ = kind.command_name.replace("-", "_")
    call.__doc__ = "\n\n".join(filter(None, [*said, "\n".join(arguments), errors]))
    call.__dict__["__signature__"] = signature.replace(
        return_annotation=kind.result.__annotations__["return"]
    )
    return call


def paragraphs(documented: Any) -> list[str]:
    """The paragraphs of a docstring."""
    return cleandoc(documented.__doc__ or "").split("\n\n")
