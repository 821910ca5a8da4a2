"""That batch jobs have their turn, however many interactive ones keep coming."""

from typing import cast

from redis import Redis

from jobs.index import record_key
from schemas.job import Priority
from schemas.messages import QUEUES

_TURN_KEY = "neuralmri:batch-turn"

# Messages are pushed on the left and taken from the right, so the right end goes next. Since when a
# job waits is `free_from_us` of its record: by the clock of Redis, whatever hosts' clocks say. An
# erased job has none; its id begins with the time of its submission, ms in 12 hexadecimal digits. A
# negative age, or a turn that ends later than any was given for: the clock went back.
_GIVE = """
local message = redis.call('LINDEX', KEYS[2], -1)
if not message then return 0 end
local time = redis.call('TIME')
local now_ms = time[1] * 1000 + math.floor(time[2] / 1000)
local id = cjson.decode(message).headers.id
local since_us = redis.call('HGET', ARGV[2] .. id, 'free_from_us')
local since_ms = since_us and math.floor(since_us / 1000) or tonumber(string.sub(id, 1, 12), 16)
local age_ms = now_ms - since_ms
if age_ms >= 0 and age_ms < tonumber(ARGV[1]) then return 0 end
if redis.call('PTTL', KEYS[1]) > tonumber(ARGV[1]) then redis.call('DEL', KEYS[1]) end
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
    arguments = (str(int(every_s * 1000)), record_key(""))
    given = redis.eval(_GIVE, 3, _TURN_KEY, batch, interactive, *arguments)
    return bool(cast(int, given))
