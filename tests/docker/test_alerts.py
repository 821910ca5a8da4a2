"""The alert rules: what Prometheus asks of such a file, and that their metrics exist."""

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[2]
RULES: list[dict[str, Any]] = [
    rule
    for group in yaml.safe_load((ROOT / "docker" / "alerts.yaml").read_text())["groups"]
    for rule in group["rules"]
]
_PAIRS = {")": "(", "]": "[", "}": "{"}

every_rule = pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule["alert"])


def metrics_of(expression: str) -> set[str]:
    """Names of ours that an expression asks for."""
    return set(re.findall(r"\bneuralmri_\w+", expression))


def documented() -> set[str]:
    """Names of samples that docs/deploy.md lists, as a rule would ask for them."""
    rows = re.findall(
        r"^\| `(neuralmri_\w+)` \| (\w+) \|", (ROOT / "docs" / "deploy.md").read_text(), re.M
    )
    names = {name for name, _ in rows}
    for name, kind in rows:
        if kind == "histogram":
            names |= {f"{name}_{part}" for part in ("bucket", "sum", "count")}
    return names


def is_balanced(expression: str) -> bool:
    """Whether brackets close in order, outside of quotes."""
    opened: list[str] = []
    for sign in re.sub(r'"[^"]*"', "", expression):
        if sign in _PAIRS.values():
            opened.append(sign)
        elif sign in _PAIRS and (not opened or opened.pop() != _PAIRS[sign]):
            return False
    return not opened and expression.count('"') % 2 == 0


def test_groups_have_names_and_alerts_have_names_of_their_own() -> None:
    content = yaml.safe_load((ROOT / "docker" / "alerts.yaml").read_text())
    assert set(content) == {"groups"}
    assert all(set(group) == {"name", "rules"} for group in content["groups"])
    names = [rule["alert"] for rule in RULES]
    assert len(names) == len(set(names))
    assert all(re.fullmatch(r"Neuralmri[A-Z]\w+", name) for name in names)


@every_rule
def test_a_rule_has_what_prometheus_asks_for_and_says_what_to_do(rule: dict[str, Any]) -> None:
    assert {"alert", "expr", "labels", "annotations"} <= set(rule)
    assert set(rule) <= {"alert", "expr", "for", "labels", "annotations"}
    assert re.fullmatch(r"\d+[smh]", rule.get("for", "0s"))
    assert rule["labels"]["severity"] in ("page", "ticket")
    assert {"summary", "remedy"} == set(rule["annotations"])
    assert is_balanced(rule["expr"])
    for window in re.findall(r"\[(.*?)\]", rule["expr"]):
        assert re.fullmatch(r"\d+[smh]", window)


@every_rule
def test_a_rule_asks_for_metrics_that_are_documented(rule: dict[str, Any]) -> None:
    """And what is documented is what a service answers: tests/service/test_metrics.py."""
    assert metrics_of(rule["expr"])
    assert metrics_of(rule["expr"]) <= documented()


def test_the_checks_find_what_is_wrong() -> None:
    assert metrics_of('sum(rate(neuralmri_gone_total{a="b"}[5m])) > 1') == {"neuralmri_gone_total"}
    assert is_balanced('sum(a{b="("}[5m])')
    assert not is_balanced("sum(a[5m)]")
    assert not is_balanced("sum(a")
