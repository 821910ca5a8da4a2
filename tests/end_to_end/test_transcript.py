import pytest

from tests.end_to_end.transcript import Step, matches, programs, steps

DOCUMENT = """
Text
```sh
$ not run
```
```console
$ echo one
one
$ curl \\
>   --silent url
{"id": "..."}
...
$ quiet
```
"""


def test_commands_and_outputs_are_told_apart() -> None:
    assert steps(DOCUMENT) == [
        Step("echo one", ("one",)),
        Step("curl \\\n  --silent url", ('{"id": "..."}', "...")),
        Step("quiet", ()),
    ]


@pytest.mark.parametrize(
    ("expected", "printed"),
    [
        ((), "anything\n"),
        (("one",), "one\n"),
        (("one",), "one"),
        (('{"id": "..."}',), '{"id": "0af3"}\n'),
        (("a", "...", "z"), "a\nb\nc\nz\n"),
        (("a", "..."), "a\n"),
        (("a (b) [c]",), "a (b) [c]\n"),
    ],
)
def test_what_fits(expected: tuple[str, ...], printed: str) -> None:
    assert matches(expected, printed)


@pytest.mark.parametrize(
    ("expected", "printed"),
    [
        (("one",), "two\n"),
        (("one",), "one\ntwo\n"),
        (("one", "two"), "one\n"),
        (('{"id": "..."}',), '{"name": "x"}\n'),
        (("a", "...", "z"), "a\nb\n"),
        (("a.c",), "abc\n"),
    ],
)
def test_what_does_not_fit(expected: tuple[str, ...], printed: str) -> None:
    assert not matches(expected, printed)


def test_programs_are_python_blocks() -> None:
    assert programs("a\n```python\nprint(1)\n```\n```sh\nb\n```\n```python\n\n```\n") == [
        "print(1)\n",
        "\n",
    ]
