answers = {
    "weld_seam": ("action", "watched_and_stoppable"),
    "water_pressure": ("topic", "start_in_any_order"),
    "bumper_hit": ("topic", "event_for_many"),
    "gps_to_field": ("service", "remote_function"),
    "close_gripper": ("action", "react_before_end"),
    "save_map": ("service", "short_with_answer"),
    "gripper_homing": ("action", "may_be_given_up"),
    "inspect_bridge": ("action", "known_end_can_change"),
    "tractor_position": ("topic", "independent_of_readers"),
    "drone_setpointss": ("topic", "stream_is_alive"),
}
