"""Finds attachments by name: this package's own, and those that installed packages declare in the
entry point group.

PDDL/M's `name@libfoo.so` and plain `name@package.module:attribute` both resolve by the name in
front of `@`: a problem never decides what code is loaded. Nor is any loaded that is not asked for:
an attachment of this package comes with its own module only, and entry points are read for names
that it does not know. A package that declares one of its names is refused.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from semantic_attachments.contract import Attachment, Kind, Memory
from semantic_attachments.guard import Guarded
from semantic_attachments.world import World

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "marsupial.attachments"

OWN: Mapping[str, str] = {
    "pathcost": "grid",
    "explorecost": "grid",
    "clearcost": "grid",
    "dockcost": "grid",
    "undockcost": "grid",
    "motioncost": "motion",
    "enoughcharge": "battery",
    "drain": "battery",
}
"""Module of each attachment of this package, by lower-case name."""


class BindingError(Exception):
    """A module that cannot be bound: none of its name, or one of another kind."""


@runtime_checkable
class HasModules(Protocol):
    """A domain, as far as binding is concerned."""

    @property
    def modules(self) -> Iterable[Any]:
        """Its modules: names, or objects with `name` and optionally `call`."""


@cache
def own(name: str) -> Attachment | None:
    """The attachment of this package with a lower-case name."""
    if name not in OWN:
        return None
    module = import_module(f"semantic_attachments.{OWN[name]}")
    attachments: tuple[Attachment, ...] = module.ATTACHMENTS
    return next(one for one in attachments if one.name.lower() == name)


@cache
def installed() -> Mapping[str, Attachment]:
    """All attachments by lower-case name.

    Raises:
        BindingError: if two packages declare the same name, or one declares something else.
    """
    found = {name: (attachment, "marsupial") for name in OWN if (attachment := own(name))}
    for point in sorted(_entry_points(), key=lambda point: (point.name, point.value)):
        for attachment in _load(point):
            name = attachment.name.lower()
            if name in found and found[name][0] is not attachment:
                raise BindingError(
                    f"attachment {attachment.name} is declared by both {found[name][1]} and "
                    f"{point.value}; uninstall one or rename it"
                )
            found[name] = (attachment, point.value)
    return {name: attachment for name, (attachment, _) in found.items()}


def _entry_points() -> set[EntryPoint]:
    from importlib.metadata import entry_points  # imported late: own attachments need none

    return set(entry_points(group=GROUP))


def _load(point: EntryPoint) -> tuple[Attachment, ...]:
    try:
        loaded = point.load()
    except (ImportError, AttributeError) as error:
        raise BindingError(f"entry point {point.name} ({point.value}): {error}") from error
    attachments = (loaded,) if isinstance(loaded, Attachment) else tuple(loaded)
    for attachment in attachments:
        if not isinstance(attachment, Attachment):
            raise BindingError(f"{point.value} holds {attachment!r}, which is no Attachment")
    return attachments


def resolve(call: str, attachments: Iterable[Attachment] = ()) -> Attachment:
    """The attachment a module's call string means; those given take precedence over installed ones.

    Args:
        call: `name`, `name@libfoo.so` or `name@package.module:attribute`.

    Raises:
        BindingError: listing the known names if none fits.
    """
    given = {attachment.name.lower(): attachment for attachment in attachments}
    name = call.partition("@")[0]
    attachment = given.get(name.lower()) or own(name.lower()) or installed().get(name.lower())
    if attachment is None:
        known = {**installed(), **given}
        names = ", ".join(sorted(attachment.name for attachment in known.values()))
        raise BindingError(
            f"no attachment is called {name!r} (from {call!r}); known are {names}. "
            f"Declare yours in the entry point group {GROUP!r} or pass it in"
        )
    return attachment


def bind(
    modules: HasModules | Iterable[str],
    world: World,
    *,
    attachments: Iterable[Attachment] = (),
    memory: Memory | None = None,
    time_limit_s: float | None = 60.0,
) -> dict[str, Guarded]:
    """What `planner.solve(attachments=...)` takes: an evaluator for each module.

    Args:
        modules: a domain, or the call strings or names of modules.
        attachments: further attachments, for those that are not installed.
        memory: that of the mission, so that values survive from one problem to the next.
        time_limit_s: the longest one evaluation, of a batch or a call, may take; None for no limit.
            Those that are `quick` have none.

    Raises:
        BindingError: if a module resolves to nothing, or to another kind than the domain
        declares.
    """
    memory = Memory() if memory is None else memory
    given = tuple(attachments)
    listed = modules.modules if isinstance(modules, HasModules) else modules
    bound = {}
    for module in listed:
        name, call, kind = _describe(module)
        attachment = resolve(call, given)
        if kind is not None and kind is not attachment.kind:
            raise BindingError(
                f"module {name} is declared as {kind}, but it is a {attachment.kind}"
            )
        declared = getattr(module, "parameters", attachment.parameters)
        if len(declared) != len(attachment.parameters):
            names = ", ".join(parameter.name for parameter in attachment.parameters)
            raise BindingError(
                f"module {name} is declared with {len(declared)} parameters; "
                f"{attachment.name} takes {len(attachment.parameters)}: {names}"
            )
        bound[name] = Guarded(attachment, attachment.bind(world, memory), time_limit_s)
    return bound


def _describe(module: Any) -> tuple[str, str, Kind | None]:
    if isinstance(module, str):
        return module.partition("@")[0], module, None
    name = str(module.name)
    kind = getattr(module, "kind", None)
    if kind == "grounding":
        raise BindingError(f"module {name}: modules that ground new objects are not supported")
    return name, str(getattr(module, "call", name)), None if kind is None else Kind(str(kind))
