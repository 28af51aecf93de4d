"""Declared checks of each kind, for the program in all_kinds.py.txt."""

from __future__ import annotations

OFFERED = """
[[checks]]
id = "offered"
kind = "offered"
title = "It works."
points = 1.0

"""
TOPICS_OFFERED = """
[[checks]]
id = "offered"
kind = "offered"
title = "It works."
points = 1.0
endpoints = ["/cmd_in", "/cmd_out", "/beat"]
"""
NODE_NAME = """
[[checks]]
id = "node"
kind = "node_name"
title = "It works."
points = 1.0
node = "all_kinds"
"""
ADDS = """
[[checks]]
id = "adds"
kind = "answers"
title = "It works."
points = 1.0
service = "/add"
requests = {a = {draw = [1, 200], count = 4}, b = {draw = [1, 10]}}
expect = {sum = "request.a + request.b"}
"""
WITHIN = """
[[checks]]
id = "within"
kind = "answers"
title = "It works."
points = 1.0
service = "/add"
cases = [{request = {a = 1, b = 2}, expect = {sum = 3}}]
within_s = 0.4
"""
TAKES_ITS_TIME = """
[[checks]]
id = "not_before"
kind = "goal_succeeds"
title = "It works."
points = 1.0
action = "/fib"
goals = [{order = 10}]
not_before_s = 0.05
"""
TOGETHER = """
[[checks]]
id = "together"
kind = "answers"
title = "It works."
points = 1.0
service = "/add"
requests = {a = {draw = [-200, 200], count = 30}, b = {draw = [0, 10]}}
expect = {sum = "request.a + request.b"}
clients = 10
within_s = 4.0
"""
CONVERTS = """
[[checks]]
id = "converts"
kind = "answers"
title = "It works."
points = 1.0
service = "/convert"
requests = [
  {value = {draw = [-100.0, 500.0], count = 3}, from_unit = "celsius", to_unit = "fahrenheit"},
  {value = -40.0, from_unit = "celsius", to_unit = "fahrenheit"},
]
expect = {success = true, value = "request.value * 9 / 5 + 32"}
"""
REFUSES = """
[[checks]]
id = "refuses"
kind = "refuses"
title = "It works."
points = 1.0
service = "/convert"
requests = [
  {value = 1, from_unit = "kelvin", to_unit = "celsius"},
  {from_unit = "celsius", to_unit = {choice = ["", "C"]}},
]
"""
CONVERTS_AND_REFUSES = CONVERTS + REFUSES
LIMITS = """
[[checks]]
id = "limits"
kind = "topic_answers"
title = "It works."
points = 1.0
publisher = "/cmd_out"
messages = [
  {linear = {x = {draw = [-3.0, 3.0], count = 4}, y = 0.5}},
  {linear.x = 0.25, angular.z = 1},
]
node = "all_kinds"
[checks.expect]
linear.x = "clamp(message.linear.x, -parameters.limit, parameters.limit)"
linear.y = "message.linear.y"
angular = "message.angular"
"""
EXACTLY_ONE = """
[[checks]]
id = "one"
kind = "topic_answers"
title = "It works."
points = 1.0
publisher = "/cmd_out"
messages = [{linear.x = 0.25}, {linear.x = 0.5}]
expect = "message"
exactly_one = true
"""
DECLARED = """
[[checks]]
id = "declared"
kind = "parameter_declared"
title = "It works."
points = 1.0
node = "all_kinds"
parameter = "limit"
default = 1.0
"""
ACTS = """
[[checks]]
id = "acts"
kind = "parameter_acts"
title = "It works."
points = 1.0
node = "all_kinds"
set = [{limit = 0.5}, {limit = {draw = [2.0, 4.0], count = 2}}]
publisher = "/cmd_out"
messages = [{linear.x = 5.0}, {linear.x = -5.0}]
expect = {linear.x = "parameters.limit if message.linear.x > 0 else -parameters.limit"}
"""
ACTS_ALONE = """
[[checks]]
id = "acts"
kind = "parameter_acts"
title = "It works."
points = 1.0
node = "all_kinds"
set = {limit = {draw = [2.0, 4.0], count = 2}}
publisher = "/beat"
expect = {data = "parameters.limit"}
"""
ACTS_AT_START = """
[[checks]]
id = "acts"
kind = "parameter_acts"
title = "It works."
points = 1.0
node = "all_kinds"
set = {limit = 0.7}
at_start = true
publisher = "/cmd_out"
messages = {linear.x = 5.0}
expect = {linear.x = 0.7}
"""
PARAMETER_REFUSES = """
[[checks]]
id = "refuses"
kind = "parameter_refuses"
title = "It works."
points = 1.0
node = "all_kinds"
set = [{limit = 0.0}, {limit = "fast"}, {unknown = 3}, {limit = {draw = [5.1, 20.0]}}]
reason = ["limit", "5.0"]
"""
NOT_ATOMIC = """
[[checks]]
id = "atomic"
kind = "parameter_refuses"
title = "It works."
points = 1.0
node = "all_kinds"
set = {name = "tank", limit = 9.0}
together = true
"""
SUCCEEDS = """
[[checks]]
id = "succeeds"
kind = "goal_succeeds"
title = "It works."
points = 1.0
action = "/fib"
cases = [
  {goal = {order = 5}, expect = {sequence = [0, 1, 1, 2, 3, 5]}},
  {goal = {order = 2}, expect = {sequence = [0, 1, 1]}},
]
within_s = 3.0
"""
FEEDBACK = """
[[checks]]
id = "feedback"
kind = "goal_feedback"
title = "It works."
points = 1.0
action = "/fib"
goals = {order = 10}
at_least = 5
spread = true
last = {sequence = [0, 1, 1, 2, 3, 5, 8, 13, 21, 34, 55]}
"""
MONOTONIC = """
[[checks]]
id = "monotonic"
kind = "goal_feedback"
title = "It works."
points = 1.0
action = "/move"
goals = {target = {x = 9.0}}
rising = ["progress", "position.x"]
falling = ["distance_remaining"]
first = {progress = 0.0}
each = {distance_remaining = "goal.target.x - feedback.position.x"}
last = {progress = 1.0}
"""
REJECTS = """
[[checks]]
id = "rejects"
kind = "goal_refused"
title = "It works."
points = 1.0
action = "/fib"
goals = [{order = -1}, {order = 51}]
"""
SECOND = """
[[checks]]
id = "second"
kind = "goal_refused"
title = "It works."
points = 1.0
action = "/fib"
goals = {order = 3}
while_running = {order = 20}
"""
CANCEL = """
[[checks]]
id = "cancel"
kind = "goal_cancelled"
title = "It works."
points = 1.0
action = "/fib"
goals = {order = 45}
then = {order = 3}
"""
ALL_DECLARED = """
[[checks]]
id = "all_declared"
kind = "parameter_declared"
title = "It works."
points = 1.0
node = "all_kinds"
parameters = ["name", "limit"]
"""
DEFAULTS = """
[[checks]]
id = "defaults"
kind = "parameter_declared"
title = "It works."
points = 1.0
node = "all_kinds"
types = { name = "string" }
defaults = { name = "rover", limit = 1.0 }
"""
