from pathlib import Path

import pytest

import domains


def test_every_folder_with_a_domain_is_found_and_complete() -> None:
    names = domains.available()
    assert {"disaster", "marsupial"} <= set(names)
    for name in names:
        formulation = domains.load(name)
        folder = Path(domains.__file__).parent / name
        assert formulation.domain_path == folder / "domain.pddl"
        assert (folder / "README.md").exists()
        assert (folder / "problems" / "expect.toml").exists()
        for module in formulation.attachments:
            assert f"({module} " in formulation.domain_path.read_text(encoding="utf-8")


def test_an_unknown_domain_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(domains.UnknownDomainError, match="did you mean 'disaster'"):
        domains.load("disater")
