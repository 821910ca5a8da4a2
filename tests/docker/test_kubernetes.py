"""The Kubernetes manifests as values: valid by the published schemas, at one with themselves, with
the images, with the compose file and with the code. No cluster was asked.
"""

import json
import re
import shutil
import subprocess
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import kubernetes_validate
import pytest
import yaml
from redis import Redis

from jobs.index import ANY_OWNER, index_key
from jobs.records import JobRecords
from jobs.settings import SECRETS_DIR, JobSettings
from jobs.store import JobStore
from schemas.job import JobKind, JobState
from schemas.messages import JobRequest
from service.settings import ServiceSettings
from tests.docker.test_compose import ROOT, SERVICES, seconds, setting_names
from tests.redis_server import RedisServer
from worker.settings import WorkerSettings

KUBERNETES = ROOT / "docker" / "kubernetes"
OVERLAYS = ("base", "keda")
_VERSION = "1.37"
_NAME = "app.kubernetes.io/name"

Document = dict[str, Any]


def documents(folder: str) -> list[Document]:
    """Everything that a kustomization names itself, without what it is built on."""
    kustomization = yaml.safe_load((KUBERNETES / folder / "kustomization.yaml").read_text())
    files = [name for name in kustomization["resources"] if name.endswith(".yaml")]
    return [
        document
        for name in files
        for document in yaml.safe_load_all((KUBERNETES / folder / name).read_text())
    ]


BASE = documents("base")
KEDA = documents("keda")
SETTINGS = dict(
    literal.split("=", 1)
    for generator in yaml.safe_load((KUBERNETES / "base" / "kustomization.yaml").read_text())[
        "configMapGenerator"
    ]
    for literal in generator["literals"]
)


def named(kind: str, name: str) -> Document:
    (found,) = (d for d in BASE if (d["kind"], d["metadata"]["name"]) == (kind, name))
    return found


def pod(name: str) -> Document:
    kind = "StatefulSet" if name == "redis" else "Deployment"
    spec: Document = named(kind, name)["spec"]["template"]["spec"]
    return spec


def container(name: str) -> Document:
    (only,) = pod(name)["containers"]
    found: Document = only
    return found


def dockerfile(name: str) -> str:
    return (ROOT / SERVICES[name]["build"]["dockerfile"]).read_text()


every_pod = pytest.mark.parametrize("name", ["api", "redis", "worker"])
ours = pytest.mark.parametrize("name", ["api", "worker"])


def is_ours_to_check(document: Document) -> bool:
    return not document["apiVersion"].startswith("keda.sh/")


@pytest.mark.parametrize(
    "document", [*BASE, *KEDA], ids=lambda d: f"{d['kind']}-{d['metadata']['name']}"
)
def test_a_document_is_as_the_published_schema_wants_it(document: Document) -> None:
    if is_ours_to_check(document):
        kubernetes_validate.validate(document, _VERSION, strict=True)
    else:
        assert document["apiVersion"] == "keda.sh/v1alpha1"
        assert set(document) == {"apiVersion", "kind", "metadata", "spec"}


def test_the_schemas_find_what_is_wrong() -> None:
    wrong = json.loads(json.dumps(named("Deployment", "api")))
    wrong["spec"]["template"]["spec"]["containers"][0]["readynessProbe"] = {}
    with pytest.raises(kubernetes_validate.ValidationError):
        kubernetes_validate.validate(wrong, _VERSION, strict=True)


@pytest.mark.parametrize("folder", OVERLAYS)
def test_every_file_is_named_by_its_kustomization(folder: str) -> None:
    kustomization = yaml.safe_load((KUBERNETES / folder / "kustomization.yaml").read_text())
    there = {path.name for path in (KUBERNETES / folder).iterdir()} - {"kustomization.yaml"}
    assert there == {name for name in kustomization["resources"] if name.endswith(".yaml")}
    assert kustomization["namespace"] == named("Namespace", "neuralmri")["metadata"]["name"]


@pytest.mark.skipif(shutil.which("kubectl") is None, reason="no kubectl to build them")
@pytest.mark.parametrize("folder", OVERLAYS)
def test_kustomize_builds_what_the_schemas_take(folder: str) -> None:
    built = subprocess.run(
        ["kubectl", "kustomize", str(KUBERNETES / folder)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stderr
    found = list(yaml.safe_load_all(built.stdout))
    for document in filter(is_ours_to_check, found):
        kubernetes_validate.validate(document, _VERSION, strict=True)
    (settings,) = (d for d in found if d["kind"] == "ConfigMap")
    assert settings["data"] == SETTINGS
    used = re.findall(r"configMapRef:\s+name: (\S+)", built.stdout)
    assert used == [settings["metadata"]["name"]] * 2
    (worker,) = (d for d in found if (d["kind"], d["metadata"]["name"]) == ("Deployment", "worker"))
    assert ("replicas" in worker["spec"]) is (folder == "base")


@every_pod
def test_a_pod_is_locked_down(name: str) -> None:
    namespace = named("Namespace", "neuralmri")["metadata"]["labels"]
    assert namespace["pod-security.kubernetes.io/enforce"] == "restricted"
    spec, only = pod(name), container(name)
    assert spec["automountServiceAccountToken"] is False
    assert spec["securityContext"]["runAsNonRoot"] is True
    assert spec["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}
    assert only["securityContext"] == {
        "allowPrivilegeEscalation": False,
        "readOnlyRootFilesystem": True,
        "capabilities": {"drop": ["ALL"]},
    }
    assert not {"hostNetwork", "hostPID", "hostIPC"} & set(spec)
    assert all("sizeLimit" in v["emptyDir"] for v in spec["volumes"] if "emptyDir" in v)
    assert {"requests", "limits"} == set(only["resources"])
    assert {"readinessProbe", "livenessProbe"} <= set(only)


@every_pod
def test_image_and_user_are_those_of_compose(name: str) -> None:
    assert container(name)["image"] == SERVICES[name]["image"]
    context = pod(name)["securityContext"]
    assert f"{context['runAsUser']}:{context['runAsGroup']}" == SERVICES[name]["user"]
    assert context["fsGroup"] == context["runAsGroup"]
    grace_s = pod(name)["terminationGracePeriodSeconds"]
    assert grace_s >= seconds(SERVICES[name]["stop_grace_period"])


@every_pod
def test_memory_is_bounded_as_in_compose(name: str) -> None:
    limit = container(name)["resources"]["limits"]["memory"]
    assert limit == SERVICES[name]["mem_limit"].replace("g", "Gi")


def test_a_worker_has_the_core_of_its_one_thread() -> None:
    resources = container("worker")["resources"]
    assert {"name": "NEURALMRI_THREADS", "value": "1"} in container("worker")["env"]
    assert resources["requests"]["cpu"] == resources["limits"]["cpu"] == "1"


def test_redis_is_configured_as_in_compose() -> None:
    def lines(script: str) -> list[str]:
        return [line for line in script.splitlines() if not line.startswith("requirepass ")]

    ours_, theirs = container("redis")["command"], SERVICES["redis"]["command"]
    assert ours_[:2] == theirs[:2]
    assert lines(ours_[2]) == lines(theirs[2])


@every_pod
def test_selectors_find_the_pods_they_mean(name: str) -> None:
    labels = {_NAME: name}
    workload = named("StatefulSet" if name == "redis" else "Deployment", name)["spec"]
    assert workload["selector"]["matchLabels"] == workload["template"]["metadata"]["labels"]
    assert workload["template"]["metadata"]["labels"] == labels


@pytest.mark.parametrize("service", [d for d in BASE if d["kind"] == "Service"], ids=str)
def test_a_service_leads_to_a_port_of_its_pods(service: Document) -> None:
    name = service["spec"]["selector"][_NAME]
    assert service["metadata"]["name"] == name
    ports = {port["name"] for port in container(name)["ports"]}
    assert {port["targetPort"] for port in service["spec"]["ports"]} <= ports


def test_the_ports_are_those_of_the_images() -> None:
    exposed = re.findall(r"^EXPOSE (\d+)$", dockerfile("api"), re.MULTILINE)
    assert [str(port["containerPort"]) for port in container("api")["ports"]] == exposed
    assert "EXPOSE" not in dockerfile("worker")
    assert "ports" not in container("worker")


@ours
def test_probes_ask_what_the_images_have(name: str) -> None:
    only = container(name)
    if name == "api":
        asked = {only[probe]["httpGet"]["path"] for probe in only if probe.endswith("Probe")}
        assert asked == {"/healthz", "/readyz"}
        described = yaml.safe_load((ROOT / "openapi.yaml").read_text())["paths"]
        assert asked <= set(described)
        assert only["startupProbe"]["httpGet"]["path"] == "/readyz"
    else:
        command = only["livenessProbe"]["exec"]["command"]
        assert json.dumps(command) in dockerfile(name)
        # A Redis that is away must not end jobs that outlive it.
        probe = only["livenessProbe"]
        assert probe["failureThreshold"] * probe["periodSeconds"] >= 300


@ours
def test_volumes_are_claimed_and_mounted_where_settings_say(name: str) -> None:
    volumes = {volume["name"]: volume for volume in pod(name)["volumes"]}
    mounts = {mount["name"]: mount["mountPath"] for mount in container(name)["volumeMounts"]}
    assert set(volumes) == set(mounts)
    assert mounts["data"] == SETTINGS["NEURALMRI_DATA_DIR"]
    assert f"NEURALMRI_DATA_DIR={mounts['data']}" in dockerfile(name)
    assert mounts["secrets"] == SETTINGS[SECRETS_DIR]
    assert mounts["tmp"] == "/tmp"
    claim = volumes["data"]["persistentVolumeClaim"]["claimName"]
    assert named("PersistentVolumeClaim", claim)["spec"]["accessModes"] == ["ReadWriteMany"]
    # A file of the Secret is found by the name of its variable.
    (item,) = volumes["secrets"]["secret"]["items"]
    assert item["path"].upper() in setting_names()


def test_no_secret_is_in_the_tree_or_in_an_environment() -> None:
    text = "".join(path.read_text() for path in KUBERNETES.rglob("*.yaml"))
    assert "kind: Secret" not in text
    assert "secretKeyRef" not in text
    assert not re.search(r"redis://[^ ]*@", text)


def test_settings_are_settings_documented_and_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    text = (ROOT / "docs" / "deploy.md").read_text()
    own = {variable["name"] for variable in container("worker").get("env", [])}
    for name in {*SETTINGS, *own}:
        assert f"`{name}" in text, name
    assert {*SETTINGS, *own} - {SECRETS_DIR} <= setting_names()
    for name in set(SETTINGS) - {SECRETS_DIR}:
        monkeypatch.setenv(name, SETTINGS[name])
    assert ServiceSettings().require_keys is True
    assert WorkerSettings().data_dir == Path(SETTINGS["NEURALMRI_DATA_DIR"])
    for name in ("api", "worker"):
        assert container(name)["envFrom"] == [{"configMapRef": {"name": "settings"}}]


def test_the_documents_name_the_keys_of_the_secret() -> None:
    items = {
        item["key"]
        for name in ("api", "redis", "worker")
        for volume in pod(name)["volumes"]
        if "secret" in volume
        for item in volume["secret"]["items"]
    }
    text = (ROOT / "docs" / "deploy.md").read_text()
    assert items == set(re.findall(r"--from-literal=(\w+)=", text))
    assert "secret generic neuralmri-redis" in text


def test_a_drain_leaves_an_api_pod() -> None:
    budget = named("PodDisruptionBudget", "api")["spec"]
    assert budget["selector"]["matchLabels"] == {_NAME: "api"}
    assert named("Deployment", "api")["spec"]["replicas"] > budget["minAvailable"]


def test_network_policies_let_through_what_is_needed_and_nothing_else() -> None:
    policies = {d["metadata"]["name"]: d["spec"] for d in BASE if d["kind"] == "NetworkPolicy"}
    nothing = policies.pop("nothing-else")
    assert nothing == {"podSelector": {}, "policyTypes": ["Ingress", "Egress"]}
    del policies["names-are-resolved"]
    for name, policy in policies.items():
        assert policy["podSelector"]["matchLabels"] == {_NAME: name}
        ports = {port["name"] for port in container(name).get("ports", [])}
        for rule in policy.get("ingress", []):
            assert {port["port"] for port in rule["ports"]} <= ports
    assert "ingress" not in policies["worker"]
    (only,) = policies["worker"]["egress"]
    assert only["to"] == [{"podSelector": {"matchLabels": {_NAME: "redis"}}}]
    assert "egress" not in policies["redis"]
    reachers = [peer.get("podSelector") for peer in policies["redis"]["ingress"][0]["from"]]
    assert [peer["matchLabels"][_NAME] for peer in reachers if peer] == ["api", "worker"]


class TestScaling:
    """By KEDA, whose scaler counts what a list, set or sorted set holds."""

    scaled, authentication = (document["spec"] for document in KEDA)

    def test_it_scales_the_workers_up_to_the_sum_of_its_triggers(self) -> None:
        assert self.scaled["scaleTargetRef"] == {"name": "worker"}
        modifiers = self.scaled["advanced"]["scalingModifiers"]
        names = [trigger["name"] for trigger in self.scaled["triggers"]]
        assert modifiers["formula"] == " + ".join(names)
        assert (modifiers["target"], modifiers["metricType"]) == ("1", "AverageValue")
        assert 1 <= self.scaled["minReplicaCount"] < self.scaled["maxReplicaCount"]
        # It would stop workers at work whenever Redis is away.
        assert "fallback" not in self.scaled

    def test_its_triggers_are_every_state_that_wants_a_worker(self) -> None:
        names = {trigger["metadata"]["listName"] for trigger in self.scaled["triggers"]}
        wanting = {state for state in JobState if not state.is_terminal}
        assert names == {index_key(ANY_OWNER, state) for state in wanting}

    def test_it_finds_redis_and_its_password(self) -> None:
        service = named("Service", "redis")
        port = service["spec"]["ports"][0]["port"]
        for trigger in self.scaled["triggers"]:
            assert trigger["type"] == "redis"
            assert trigger["metadata"]["address"] == f"redis.neuralmri.svc:{port}"
            assert trigger["authenticationRef"] == {"name": KEDA[1]["metadata"]["name"]}
        (secret,) = self.authentication["secretTargetRef"]
        volume = next(v for v in pod("redis")["volumes"] if "secret" in v)["secret"]
        assert secret["name"] == volume["secretName"]
        assert secret["key"] == volume["items"][0]["key"]

    def test_it_is_spelled_as_kedas_definition_wants_it(self) -> None:
        assert set(self.scaled) == {
            *("scaleTargetRef", "minReplicaCount", "maxReplicaCount", "pollingInterval"),
            *("advanced", "triggers"),
        }
        assert set(self.scaled["advanced"]) == {"scalingModifiers", "horizontalPodAutoscalerConfig"}
        for trigger in self.scaled["triggers"]:
            assert set(trigger) == {"type", "name", "metadata", "authenticationRef"}
            assert all(isinstance(value, str) for value in trigger["metadata"].values())
        behavior = self.scaled["advanced"]["horizontalPodAutoscalerConfig"]["behavior"]
        assert behavior["scaleUp"] == {"stabilizationWindowSeconds": 0}
        assert behavior["scaleDown"]["stabilizationWindowSeconds"] <= 3600
        assert behavior["scaleDown"]["policies"][0]["periodSeconds"] <= 1800

    def test_scaling_down_waits_longer_than_a_job_is_handed_back(self) -> None:
        down = self.scaled["advanced"]["horizontalPodAutoscalerConfig"]["behavior"]["scaleDown"]
        (policy,) = down["policies"]
        assert policy["value"] == 1
        assert policy["periodSeconds"] > pod("worker")["terminationGracePeriodSeconds"]

    def test_jobs_that_wait_and_jobs_at_work_count_and_ended_ones_do_not(
        self, redis: Redis, records: JobRecords, store: JobStore
    ) -> None:
        ids = [store.new_id() for _ in range(3)]
        for job_id in ids:
            request = JobRequest(
                job_id=job_id, kind=JobKind.CONTOURS, created_at=datetime.now(tz=UTC)
            )
            records.accepted(request)
        assert records.claim(ids[0], 30.0, 3).granted
        assert records.claim(ids[1], 30.0, 3).granted
        assert records.request_cancel(ids[1]) is JobState.CANCELLING
        counted = {
            t["name"]: redis.zcard(t["metadata"]["listName"]) for t in self.scaled["triggers"]
        }
        assert counted == {"queued": 1, "running": 1, "cancelling": 1}
        records.request_cancel(ids[2])
        assert redis.zcard(self.scaled["triggers"][0]["metadata"]["listName"]) == 0


@pytest.fixture
def settings(redis_server: RedisServer, tmp_path: Path) -> JobSettings:
    return JobSettings(redis_url=redis_server.url, data_dir=tmp_path / "data", redis_timeout_s=1.0)
