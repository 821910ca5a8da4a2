import asyncio

from jobs.cancelled_tasks import end_tasks
from jobs.redis_client import make_async_redis
from jobs.settings import JobSettings


async def deaf(times: int) -> None:
    """Ignores being cancelled, a few times."""
    for _ in range(times):
        try:
            await asyncio.sleep(30.0)
        except asyncio.CancelledError:
            continue
    await asyncio.sleep(30.0)


def test_tasks_end_however_deaf_they_are() -> None:
    async def run() -> bool:
        tasks = [asyncio.create_task(deaf(times)) for times in range(4)]
        await asyncio.sleep(0.0)
        await end_tasks(*tasks)
        return all(task.done() for task in tasks)

    assert asyncio.run(run())


def test_tasks_that_ended_or_failed_are_no_trouble() -> None:
    async def fails() -> None:
        raise ValueError("expected")

    async def run() -> None:
        done = asyncio.create_task(asyncio.sleep(0.0))
        failed = asyncio.create_task(fails())
        await asyncio.wait([done, failed])
        await end_tasks(done, failed)
        assert failed.exception() is not None

    asyncio.run(run())


def test_a_command_can_be_cancelled_in_any_of_its_moments(settings: JobSettings) -> None:
    async def run() -> None:
        async with make_async_redis(settings.redis_url) as redis:

            async def commands() -> None:
                while True:
                    await redis.get("anything")
                    await asyncio.sleep(0.01)

            for moment in range(40):
                task = asyncio.create_task(commands())
                for _ in range(moment):
                    await asyncio.sleep(0.0)
                async with asyncio.timeout(5.0):
                    await end_tasks(task)
                assert await redis.ping()

    asyncio.run(run())
