import base64

import pytest

from service.webhooks.signature import new_secret, signature, signed_headers

SECRET = "whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw"
ID = "msg_p5jXN8AQM9LWM0D4loKWxJek"
AT_S = 1614265330
BODY = b'{"test": 2432232314}'
SIGNATURE = "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE="


@pytest.mark.parametrize("secret", [SECRET, SECRET.removeprefix("whsec_")])
def test_known_answer_of_the_specifications_libraries(secret: str) -> None:
    assert signature(secret, ID, AT_S, BODY) == SIGNATURE


def test_headers_carry_a_signature_by_each_secret() -> None:
    other = new_secret()
    assert signed_headers([other, SECRET], ID, AT_S, BODY) == {
        "webhook-id": ID,
        "webhook-timestamp": "1614265330",
        "webhook-signature": f"{signature(other, ID, AT_S, BODY)} {SIGNATURE}",
    }


@pytest.mark.parametrize(
    "changed", [(ID + "x", AT_S, BODY), (ID, AT_S + 1, BODY), (ID, AT_S, BODY + b" ")]
)
def test_whatever_is_changed_changes_the_signature(changed: tuple[str, int, bytes]) -> None:
    assert signature(SECRET, *changed) != SIGNATURE


def test_secrets_are_long_and_differ() -> None:
    drawn = {new_secret() for _ in range(100)}
    assert len(drawn) == 100
    for secret in drawn:
        assert 24 <= len(base64.b64decode(secret.removeprefix("whsec_"))) <= 64
