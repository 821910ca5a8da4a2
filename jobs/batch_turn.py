"""That batch jobs have their turn, however many interactive ones keep coming."""

from typing import cast

from redis import Redis

from schemas.job import Priority
from schemas.messages import QUEUES

_TURN_KEY = "neuralmri:batch-turn"

# Messages are pushed on the left and taken from the right, so the right end goes next. A job's id
# begins with the time of its submission, ms in 12 hexadecimal digits.
_GIVE = """
local message = redis.call('LINDEX', KEYS[2], -1)
if not message then return 0 end
local time = redis.call('TIME')
local now_ms = time[1] * 1000 + math.floor(time[2] / 1000)
local sent_ms = tonumber(string.sub(cjson.decode(message).headers.id, 1, 12), 16)
if now_ms - sent_ms < tonumber(ARGV[1]) then return 0 end
if not redis.call('SET', KEYS[1], '1', 'NX', 'PX', ARGV[1]) then return 0 end
redis.call('RPUSH', KEYS[3], redis.call('RPOP', KEYS[2]))
return 1
"""


def give_batch_turn(redis: Redis, every_s: float) -> bool:
    """Put the oldest batch message before every interactive one, if it is `every_s` old.

    No two messages are moved within `every_s`, so interactive jobs lose little by it. Called from
    time to time, by any number of processes. Where nothing interactive waits, it changes nothing
    but the list that the message lies in. Returns whether a message was moved. Raises RedisError.
    """
    batch, interactive = QUEUES[Priority.BATCH], QUEUES[Priority.INTERACTIVE]
    given = redis.eval(_GIVE, 3, _TURN_KEY, batch, interactive, str(int(every_s * 1000)))
    return bool(cast(int, given))
