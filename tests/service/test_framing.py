from tests.service.conftest import Api


def test_two_framings_are_refused_and_the_connection_with_them(api: Api) -> None:
    answer = api.client.post(
        "/v1/jobs/contours",
        content=b"0\r\n\r\n",
        headers={"Transfer-Encoding": "chunked", "Content-Length": "5"},
    )
    assert answer.status_code == 400
    assert answer.headers["connection"] == "close"
    assert "Remedy" in answer.json()["detail"]


def test_no_address_leads_to_another_host(api: Api) -> None:
    answer = api.client.get("/v1/jobs/", headers={"Host": "evil.example"})
    assert answer.status_code == 404
    assert "location" not in answer.headers
