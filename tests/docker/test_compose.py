"""The compose file as a value: every property that its safety rests on."""

import importlib
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml
from pydantic_settings import BaseSettings

ROOT = Path(__file__).parents[2]
COMPOSE = ROOT / "docker" / "compose.yaml"
CONTENT: dict[str, Any] = yaml.safe_load(COMPOSE.read_text())
SERVICES: dict[str, dict[str, Any]] = CONTENT["services"]

every_service = pytest.mark.parametrize("name", sorted(SERVICES))


def seconds(text: str) -> float:
    matched = re.fullmatch(r"(\d+)s", text)
    assert matched, f"write {text} in seconds"
    return float(matched[1])


def setting_names() -> set[str]:
    """The environment name of every setting of every process."""
    names = set()
    for path in ROOT.glob("*/settings.py"):
        module = importlib.import_module(f"{path.parent.name}.settings")
        for value in vars(module).values():
            if isinstance(value, type) and issubclass(value, BaseSettings):
                prefix = value.model_config.get("env_prefix", "")
                names |= {f"{prefix}{field}".upper() for field in value.model_fields}
    return names


_KEYS = {
    *("image", "build", "user", "command", "environment", "volumes", "tmpfs", "networks", "ports"),
    *("init", "restart", "read_only", "cap_drop", "security_opt", "logging", "mem_limit"),
    *("cpus", "cpu_shares", "pids_limit", "stop_signal", "stop_grace_period"),
    *("depends_on", "healthcheck"),
}
"""Keys of a service, as the Compose Specification spells them."""


@every_service
def test_keys_are_spelled_as_the_specification_does(name: str) -> None:
    assert set(SERVICES[name]) <= _KEYS


def test_has_the_three_processes() -> None:
    assert set(SERVICES) == {"redis", "api", "worker"}


@every_service
def test_is_hardened(name: str) -> None:
    service = SERVICES[name]
    assert service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert "cap_add" not in service
    assert "privileged" not in service
    assert service["security_opt"] == ["no-new-privileges:true"]
    assert any(mount.startswith("/tmp:") and "size=" in mount for mount in service["tmpfs"])
    user, group = service["user"].split(":")
    assert int(user) > 0
    assert int(group) > 0


@every_service
def test_is_bounded_and_comes_back(name: str) -> None:
    service = SERVICES[name]
    assert service["restart"] == "unless-stopped"
    assert service["init"] is True
    assert service["mem_limit"]
    assert service["cpus"] > 0
    assert service["pids_limit"] > 0
    assert set(service["logging"]["options"]) == {"max-size", "max-file"}
    health = service["healthcheck"]
    assert health["test"][0] in ("CMD", "CMD-SHELL")
    assert {"interval", "timeout", "start_period", "retries"} <= set(health)


@every_service
def test_image_is_pinned(name: str) -> None:
    tag = SERVICES[name]["image"].partition(":")[2]
    assert re.match(r"\d+\.\d+\.\d+", tag)


def test_own_images_carry_the_project_version() -> None:
    pyproject = (ROOT / "pyproject.toml").read_text()
    version = re.search(r'^version = "(.+)"', pyproject, re.MULTILINE)
    assert version
    for name in ("api", "worker"):
        assert SERVICES[name]["image"].endswith(f":{version[1]}")
        assert (COMPOSE.parent / SERVICES[name]["build"]["context"]).resolve() == ROOT
        assert (ROOT / SERVICES[name]["build"]["dockerfile"]).is_file()


def test_only_the_api_is_published_and_on_loopback_by_default() -> None:
    assert [name for name, service in SERVICES.items() if "ports" in service] == ["api"]
    assert SERVICES["api"]["ports"] == ["${NEURALMRI_PUBLISH:-127.0.0.1:8000}:8000"]
    assert all("network_mode" not in service for service in SERVICES.values())


def test_redis_and_workers_reach_nothing_but_the_queue() -> None:
    assert SERVICES["redis"]["networks"] == ["queue"]
    assert SERVICES["worker"]["networks"] == ["queue"]
    assert CONTENT["networks"]["queue"] == {"internal": True}


def test_password_is_required_and_has_no_default() -> None:
    used = re.findall(r"\$\{NEURALMRI_REDIS_PASSWORD([^}]*)\}", COMPOSE.read_text())
    assert len(used) >= 2
    assert all(rest.startswith(":?") for rest in used)
    assert all("requirepass" not in word for word in SERVICES["redis"]["command"][:-1])


def test_environment_names_are_settings() -> None:
    used = {
        name
        for service in SERVICES.values()
        for name in service.get("environment", {})
        if name.startswith("NEURALMRI_")
    }
    assert {"NEURALMRI_REDIS_URL", "NEURALMRI_DATA_DIR"} <= used
    assert used <= setting_names()


def test_api_and_worker_share_queue_and_job_store() -> None:
    for name in ("NEURALMRI_REDIS_URL", "NEURALMRI_DATA_DIR"):
        assert SERVICES["api"]["environment"][name] == SERVICES["worker"]["environment"][name]
    assert SERVICES["api"]["volumes"] == SERVICES["worker"]["volumes"]
    assert SERVICES["api"]["user"] == SERVICES["worker"]["user"]
    folder = SERVICES["api"]["volumes"][0].partition(":")[2]
    assert SERVICES["api"]["environment"]["NEURALMRI_DATA_DIR"] == folder


def test_named_volumes_are_declared() -> None:
    used = {mount.partition(":")[0] for s in SERVICES.values() for mount in s["volumes"]}
    assert used == set(CONTENT["volumes"])


def test_worker_scales() -> None:
    """Nothing that a second container of the same service could not have too."""
    assert not {"container_name", "hostname", "ports"} & set(SERVICES["worker"])


def test_grace_to_stop_exceeds_what_stopping_takes() -> None:
    # In an interpreter of its own: the application is one that a process has only one of.
    asked = "from worker.app import app; print(app.conf.worker_soft_shutdown_timeout)"
    answer = subprocess.run(
        [sys.executable, "-c", asked], capture_output=True, cwd=ROOT, check=True
    )
    soft_shutdown_s = float(answer.stdout)
    assert soft_shutdown_s > 0
    assert seconds(SERVICES["worker"]["stop_grace_period"]) >= 2 * soft_shutdown_s
    assert "REMAP_SIGTERM" not in SERVICES["worker"]["environment"]
    command = (ROOT / "docker" / "service.Dockerfile").read_text()
    graceful = re.search(r'"--timeout-graceful-shutdown", "(\d+)"', command)
    assert graceful
    assert seconds(SERVICES["api"]["stop_grace_period"]) > float(graceful[1])


def test_health_checks_are_the_images_own() -> None:
    for name in ("api", "worker"):
        dockerfile = (ROOT / SERVICES[name]["build"]["dockerfile"]).read_text()
        written = re.search(r"HEALTHCHECK .*\\\n  CMD (\[.*\])", dockerfile)
        assert written
        assert SERVICES[name]["healthcheck"]["test"] == ["CMD", *json.loads(written[1])]


def test_api_and_worker_wait_for_redis() -> None:
    for name in ("api", "worker"):
        assert SERVICES[name]["depends_on"] == {"redis": {"condition": "service_healthy"}}


@pytest.mark.skipif(shutil.which("docker") is None, reason="no docker command here")
def test_compose_itself_accepts_the_file() -> None:
    """Only where the compose plugin is there; it needs no engine to read a file."""
    if subprocess.run(
        ["docker", "compose", "version"], capture_output=True, check=False
    ).returncode:
        pytest.skip("docker has no compose plugin here")
    command = ["docker", "compose", "-f", str(COMPOSE), "config", "--quiet"]
    password = {
        "PATH": str(Path(shutil.which("docker") or "").parent),
        "NEURALMRI_REDIS_PASSWORD": "a1",
    }
    accepted = subprocess.run(command, env=password, capture_output=True, text=True, check=False)
    assert accepted.returncode == 0, accepted.stderr
    refused = subprocess.run(
        command, env={"PATH": password["PATH"]}, capture_output=True, check=False
    )
    assert refused.returncode != 0
