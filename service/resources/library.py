"""Domains and maps by name, and what a mission or a planning request means by a name."""

import asyncio
from collections.abc import Callable

from domains import catalogue
from service.coordination.ports import Fault, ResolvedMission, UnresolvedError
from service.messages.map_grid import MapMessage
from service.messages.mission import CreateMission, MissionRequest, Task
from service.messages.planning import PlanRequest, PlanSubmission, PlanTask
from service.messages.resource import ResourceKind, UsedResource
from service.resources.domain_check import version_of
from service.store.resource_store import ANY_VERSION, NO_VERSION, Content, ResourceStore, Stored

EVERY_FLEET = "*"
BUILT_IN = "built in"
"""Who made the versions that come with this software."""


class UnknownResourceError(Exception):
    """A name that means nothing here."""


class Library:
    """What the service keeps."""

    def __init__(self, store: ResourceStore) -> None:
        self.store = store

    def install_built_in(self) -> None:
        """Keeps this software's domains; one that an operator has replaced stays replaced."""
        for name in catalogue.available():
            text = catalogue.load(name).domain_path.read_text(encoding="utf-8")
            content = Content(version_of(text, name), text, name)
            found = self.store.find("domain", name)
            current = found[0] if found else None
            if current is None or current.created_by == BUILT_IN:
                expected = NO_VERSION if current is None else ANY_VERSION
                self.store.put(
                    "domain", name, content, fleet=EVERY_FLEET, by=BUILT_IN, expected=expected
                )

    def find(self, kind: ResourceKind, reference: str, reaches: Callable[[str], bool]) -> Stored:
        """The version that `name` or `name@version` means.

        Args:
            reaches: whether the asker may see what belongs to a fleet.

        Raises:
            UnknownResourceError: there is none, or more than one begins so.
        """
        name, _, version = reference.partition("@")
        found = self.store.find(kind, name, version or None)
        if not found or not (found[0].fleet == EVERY_FLEET or reaches(found[0].fleet)):
            known = self.store.find(kind, name)
            if known and (known[0].fleet == EVERY_FLEET or reaches(known[0].fleet)):
                raise UnknownResourceError(
                    f"the {kind} {name!r} has no version {version!r}; "
                    f"the current one is {known[0].version}"
                )
            names = [
                one.name
                for one in self.store.listed(kind)
                if one.fleet == EVERY_FLEET or reaches(one.fleet)
            ]
            there_are = (
                f"there are {', '.join(names[:20])}" if names else f"upload one to /v1/{kind}s"
            )
            raise UnknownResourceError(f"there is no {kind} {name!r}: {there_are}")
        if len(found) > 1:
            raise UnknownResourceError(
                f"more than one version of the {kind} {name!r} begins with {version!r}; write more "
                "of it"
            )
        return found[0]

    async def mission(self, request: MissionRequest) -> ResolvedMission:
        """A mission with its domain and map.

        Raises:
            UnresolvedError: it names what its fleet does not have.
        """
        return await asyncio.to_thread(self._mission, request)

    def _mission(self, request: MissionRequest) -> ResolvedMission:
        def reaches(fleet: str) -> bool:
            return fleet == request.fleet

        faults: list[Fault] = []
        used = []
        domain = None
        try:
            domain = self.find("domain", request.domain, reaches)
            used.append(_used(domain))
            if domain.formulation is None:
                faults.append(
                    (
                        "/domain",
                        f"the domain {domain.name!r} was uploaded without a formulation: it is for "
                        "planning requests only",
                    )
                )
        except UnknownResourceError as error:
            faults.append(("/domain", str(error)))
        grid = request.map
        if isinstance(grid, str):
            try:
                stored = self.find("map", grid, reaches)
                used.append(_used(stored))
                grid = MapMessage.model_validate_json(stored.body)
            except UnknownResourceError as error:
                faults.append(("/map", str(error)))
        if faults or domain is None or domain.formulation is None or isinstance(grid, str):
            raise UnresolvedError(faults)
        task = {name: getattr(request, name) for name in Task.model_fields}
        resolved = CreateMission(**task, domain=domain.formulation, map=grid)
        return ResolvedMission(resolved, domain.body, tuple(used))

    async def planning(
        self, request: PlanSubmission, reaches: Callable[[str], bool]
    ) -> PlanRequest:
        """A planning request with the texts of what it names.

        Raises:
            UnresolvedError: it names what is not there.
        """
        return await asyncio.to_thread(self._planning, request, reaches)

    def _planning(self, request: PlanSubmission, reaches: Callable[[str], bool]) -> PlanRequest:
        faults: list[Fault] = []
        text, grid = request.domain_text, request.map
        if request.domain is not None:
            try:
                text = self.find("domain", request.domain, reaches).body
            except UnknownResourceError as error:
                faults.append(("/domain", str(error)))
        if isinstance(grid, str):
            try:
                body = self.find("map", grid, reaches).body
                grid = MapMessage.model_validate_json(body)
            except UnknownResourceError as error:
                faults.append(("/map", str(error)))
        if faults or isinstance(grid, str):
            raise UnresolvedError(faults)
        task = {name: getattr(request, name) for name in PlanTask.model_fields}
        return PlanRequest(**task, domain_text=text, map=grid)


def _used(stored: Stored) -> UsedResource:
    return UsedResource(kind=stored.kind, name=stored.name, version=stored.version)
