"""`compose.yaml` and the Dockerfile, as far as they can be checked without an engine."""

import re
from pathlib import Path
from typing import Any

import typer
import yaml
from typer.main import get_command

from service.commands.serve import serve

ROOT = Path(__file__).parents[2]
COMPOSE: dict[str, Any] = yaml.safe_load((ROOT / "compose.yaml").read_text(encoding="utf-8"))
DOCKERFILE = (ROOT / "Dockerfile").read_text(encoding="utf-8")


def options() -> set[str]:
    """Long options of `marsupial serve`, and the variables that stand for some."""
    app = typer.Typer()
    app.command()(serve)
    parameters = get_command(app).params
    names = {option for parameter in parameters for option in parameter.opts}
    return names | {str(p.envvar) for p in parameters if getattr(p, "envvar", None)}


def test_every_option_exists() -> None:
    command, *arguments = COMPOSE["services"]["service"]["command"]
    assert command == "serve"
    asked = {argument.partition("=")[0] for argument in arguments}
    asked |= set(COMPOSE["services"]["service"]["environment"])
    (in_image,) = re.findall(r'^CMD \["serve", (.*)\]$', DOCKERFILE, re.MULTILINE)
    asked |= {word for word in re.findall(r'"([^"]*)"', in_image) if word.startswith("--")}
    assert asked <= options()


def test_services_secrets_and_volumes_hang_together() -> None:
    service, database = COMPOSE["services"]["service"], COMPOSE["services"]["database"]
    assert set(service["secrets"]) == set(COMPOSE["secrets"])
    assert {volume.split(":")[0] for volume in database["volumes"]} == set(COMPOSE["volumes"])
    assert set(service["depends_on"]) <= set(COMPOSE["services"])
    assert "healthcheck" in database
    url = service["environment"]["MARSUPIAL_DB"]
    assert f"@database/{database['environment']['POSTGRES_DB']}" in url
    assert f"//{database['environment']['POSTGRES_USER']}:" in url
    # What is published is the machine's own; a proxy with TLS stands before it.
    assert all(port.startswith("127.0.0.1:") for port in service["ports"])


def test_the_image_has_what_the_service_needs() -> None:
    assert "[postgres,telemetry]" in DOCKERFILE
    extras = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert all(f"\n{extra} = [" in extras for extra in ("postgres", "telemetry"))
    stages = re.findall(r"^FROM \S+(?: AS (\w+))?$", DOCKERFILE, re.MULTILINE)
    copied = set(re.findall(r"--from=(\w+)", DOCKERFILE))
    assert copied <= set(stages)
