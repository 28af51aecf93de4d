answers = {
    " WELD_SEAM": ("Action ", " watched_and_stoppable"),
    " WATER_PRESSURE": ("Topic ", " start_in_any_order"),
    " BUMPER_HIT": ("Topic ", " event_for_many"),
    " DRONE_SETPOINTS": ("Topic ", " stream_is_alive"),
    " GPS_TO_FIELD": ("Service ", " remote_function"),
    " CLOSE_GRIPPER": ("Action ", " react_before_end"),
    " SAVE_MAP": ("Service ", " short_with_answer"),
    " GRIPPER_HOMING": ("Action ", " may_be_given_up"),
    " INSPECT_BRIDGE": ("Action ", " known_end_can_change"),
    " TRACTOR_POSITION": ("Topic ", " independent_of_readers"),
}
