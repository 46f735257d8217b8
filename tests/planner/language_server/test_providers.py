"""Installed attachments: known, unknown, or too broken to be loaded."""

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from planner.language_server import providers
from planner.language_server.providers import Providers, providers_for

WITH_MODULES = b"(define (domain d) (:MODULES (m cost f@l)))"


@dataclass(frozen=True)
class Point:
    """An entry point."""

    name: str
    load: Callable[[], object]
    value: str = "package:ATTACHMENTS"


def broken() -> object:
    raise OSError("no such library")


@pytest.fixture
def installed(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Makes entry points the installed ones."""

    def install(*points: Point) -> None:
        monkeypatch.setattr(providers, "entry_points", lambda **_: points)

    return install


def test_nothing_is_loaded_for_a_domain_without_modules(installed: Callable[..., None]) -> None:
    installed(Point("a", broken))
    assert providers_for(b"(define (domain d))") == Providers(None)


def test_names_of_all_packages_are_known(installed: Callable[..., None]) -> None:
    names = [SimpleNamespace(name="pathCost"), SimpleNamespace(name="battery")]
    installed(Point("b", lambda: names[:1]), Point("a", lambda: names[1:]))
    assert providers_for(WITH_MODULES) == Providers(["battery", "pathCost"])


def test_a_package_that_cannot_be_loaded_is_named(installed: Callable[..., None]) -> None:
    installed(Point("a", broken))
    found = providers_for(WITH_MODULES)
    assert found.names is None
    assert found.fault is not None
    assert "no such library" in found.fault


def test_without_any_package_nothing_is_known(installed: Callable[..., None]) -> None:
    installed()
    assert providers_for(WITH_MODULES) == Providers(None)
