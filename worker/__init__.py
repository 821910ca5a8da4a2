"""The worker: celery on the outside, the science inside."""
