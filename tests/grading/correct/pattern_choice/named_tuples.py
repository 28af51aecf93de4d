from enum import Enum
from typing import NamedTuple


class Pattern(str, Enum):
    TOPIC = "topic"
    SERVICE = "service"
    ACTION = "action"


class Answer(NamedTuple):
    pattern: Pattern
    reason: str


answers = {
    "weld_seam": Answer(Pattern.ACTION, "watched_and_stoppable"),
    "water_pressure": Answer(Pattern.TOPIC, "start_in_any_order"),
    "bumper_hit": Answer(Pattern.TOPIC, "event_for_many"),
    "drone_setpoints": Answer(Pattern.TOPIC, "stream_is_alive"),
    "gps_to_field": Answer(Pattern.SERVICE, "remote_function"),
    "close_gripper": Answer(Pattern.ACTION, "react_before_end"),
    "save_map": Answer(Pattern.SERVICE, "short_with_answer"),
    "gripper_homing": Answer(Pattern.ACTION, "may_be_given_up"),
    "inspect_bridge": Answer(Pattern.ACTION, "known_end_can_change"),
    "tractor_position": Answer(Pattern.TOPIC, "independent_of_readers"),
}
