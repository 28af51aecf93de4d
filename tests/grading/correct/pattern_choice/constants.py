TOPIC, SERVICE, ACTION = "topic", "service", "action"
answers = {
    "weld_seam": (ACTION, "watched_and_stoppable"),
    "water_pressure": (TOPIC, "start_in_any_order"),
    "bumper_hit": (TOPIC, "event_for_many"),
    "drone_setpoints": (TOPIC, "stream_is_alive"),
    "gps_to_field": (SERVICE, "remote_function"),
    "close_gripper": (ACTION, "react_before_end"),
    "save_map": (SERVICE, "short_with_answer"),
    "gripper_homing": (ACTION, "may_be_given_up"),
    "inspect_bridge": (ACTION, "known_end_can_change"),
    "tractor_position": (TOPIC, "independent_of_readers"),
}
