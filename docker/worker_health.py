"""Health of this container's worker: exit code 0 while it is connected and taking jobs.

It asks Redis for the worker's own heartbeat, which comes from the loop that takes jobs; a process
that is there but no longer consumes is unhealthy.
"""

import socket
import sys

from jobs.live_workers import LiveWorkers
from jobs.redis_client import make_redis
from jobs.settings import JobSettings

settings = JobSettings()
name = f"celery@{socket.gethostname()}"
with make_redis(settings.redis_url, settings.redis_timeout_s) as redis:
    alive = LiveWorkers(redis).names(settings.worker_alive_s)
if name not in alive:
    sys.exit(f"{name} has given no sign of life for {settings.worker_alive_s:g} s")
