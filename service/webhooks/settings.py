"""Settings of webhooks, from the environment: NEURALMRI_WEBHOOK_ALLOW and so on."""

from ipaddress import ip_network

from pydantic import Field, field_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

from service.webhooks.target_rules import TargetRules


class WebhookSettings(BaseSettings):
    """Where messages may go, how soon and how often. The defaults reach public https only."""

    model_config = SettingsConfigDict(env_prefix="NEURALMRI_", frozen=True, extra="ignore")

    webhook_allow: str | None = Field(
        default=None,
        description="Networks that are not public and yet may be sent to, as 10.1.0.0/16,fd00::/8.",
    )
    webhook_http: bool = Field(default=False, description="Whether http will do.")
    webhook_high_ports: bool = Field(
        default=False, description="Whether ports from 1024 on will do, beside 443 and 80."
    )
    webhook_every_s: float = Field(
        default=1.0, gt=0.0, le=60.0, description="Time between two looks for what has ended."
    )
    webhook_timeout_s: float = Field(
        default=15.0, gt=0.0, le=60.0, description="How long one attempt may take."
    )
    webhook_retry_s: str = Field(
        default="0,5,300,1800,7200,18000,36000,36000",
        description="How long each attempt waits for the one before; the last is the last.",
    )
    webhook_concurrency: int = Field(
        default=8, ge=1, le=64, description="Attempts at a time; two of them to one endpoint."
    )
    webhook_disable_after_s: float = Field(
        default=432000.0,
        gt=0.0,
        description="How long an endpoint may fail, without a success, before it is disabled.",
    )
    webhook_overlap_s: float = Field(
        default=86400.0, ge=0.0, description="How long a rotated secret still signs."
    )
    webhook_max_endpoints: int = Field(default=20, ge=1, le=1000, description="Of one owner.")
    webhook_log: int = Field(
        default=200, ge=1, le=10000, description="Ended deliveries kept for each endpoint."
    )

    @field_validator("webhook_allow")
    @classmethod
    def _are_networks(cls, text: str | None) -> str | None:
        for network in _parts(text or ""):
            ip_network(network)
        return text

    @field_validator("webhook_retry_s")
    @classmethod
    def _are_delays(cls, text: str) -> str:
        delays_s = [float(part) for part in _parts(text)]
        if not delays_s or not all(0.0 <= delay_s <= 30 * 86400 for delay_s in delays_s):
            raise ValueError("name at least one delay, each of 0 to 2592000 seconds")
        return text

    @property
    def webhook_delays_s(self) -> tuple[float, ...]:
        return tuple(float(part) for part in _parts(self.webhook_retry_s))

    @property
    def webhook_targets(self) -> TargetRules:
        return TargetRules(
            http=self.webhook_http,
            high_ports=self.webhook_high_ports,
            allow=tuple(ip_network(part) for part in _parts(self.webhook_allow or "")),
        )


def _parts(text: str) -> list[str]:
    return [part.strip() for part in text.split(",") if part.strip()]
