"""The Celery configuration that producer and worker share, and why each value is what it is."""

from typing import Any

from jobs.settings import JobSettings
from schemas.messages import QUEUES, RECONSTRUCT_QUEUE


def celery_settings(settings: JobSettings) -> dict[str, Any]:
    """Keyword arguments for `app.conf.update`. The worker adds its own pool and thread settings."""
    return {
        "broker_url": settings.redis_url,
        "broker_connection_retry_on_startup": True,
        "broker_connection_timeout": settings.redis_timeout_s,
        "broker_pool_acquire_timeout": settings.redis_timeout_s,
        "broker_transport_options": {
            # Redis delivers an unacknowledged message again after this long, while its task still
            # runs if need be; the shortest value of any process on the broker wins.
            "visibility_timeout": settings.visibility_timeout_s,
            "unacked_restore_throttle": 1,
            # A free worker takes from the first queue by name that is not empty. The default takes
            # turns, and `priority` means the order in which queues were subscribed to.
            "queue_order_strategy": "sorted",
            "socket_timeout": max(settings.redis_timeout_s, 2.0),
            "socket_connect_timeout": settings.redis_timeout_s,
            "socket_keepalive": True,
            "health_check_interval": 10,
        },
        "task_default_queue": RECONSTRUCT_QUEUE,
        # A worker that is told no queues takes from all of these.
        "task_queues": {name: {"routing_key": name} for name in QUEUES.values()},
        "task_serializer": "json",
        "accept_content": ["json"],
        # State is in the job's record and folder; Celery's own would be a second, weaker truth.
        "result_backend": None,
        "task_ignore_result": True,
        # A message is acknowledged when its task ends, and comes back when the process dies. The
        # claim counts the attempts, so a job that kills its worker does not come back for ever.
        "task_acks_late": True,
        "task_reject_on_worker_lost": True,
        "task_acks_on_failure": True,
        "task_acks_on_timeout": True,
        "worker_prefetch_multiplier": 1,
        # A Redis that refuses a write (its disk or its memory is full) is waited for like one that
        # is away. Otherwise the refusal of one acknowledgement ends the whole worker.
        "broker_channel_error_retry": True,
        # A job outlives a broken connection: its lease says that it is being worked on.
        "worker_cancel_long_running_tasks_on_connection_loss": False,
        "task_soft_time_limit": settings.soft_time_limit_s,
        "task_time_limit": settings.hard_time_limit_s,
        "worker_hijack_root_logger": False,
        "task_publish_retry": False,
    }
