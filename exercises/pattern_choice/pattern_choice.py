"""Exercise 4: which communication pattern fits?

- For each of your ten scenarios you get half a point for the pattern that fits:
  `topic`, `service` or `action`. You get another half point for the reason that
  decides: one of the four below the scenario.
- Several reasons may be true, but only one decides: if that one were not true,
  you would choose another pattern.
- In a few scenarios two patterns can be defended. Then each of the two counts,
  with the reason that belongs to it.
- The answers are a dictionary called `answers`. Each scenario has an entry: the
  id of the scenario, then the pattern and the id of the reason, as in
  `"some_robot": ("topic", "some_reason"),`. Capital letters in these words, and
  spaces around them, do not matter. Keep it a plain dictionary of texts: then
  the grader only reads your file. If your file computes the answers, the grader
  runs it.
- An answer that is missing or malformed earns nothing, and the others count. An
  entry that belongs to no scenario is reported; it costs nothing by itself.
"""

answers = {
    # ---- 1. Welding along a seam ----
    # An arm has to move its torch along a seam in 25 seconds, through 300 given
    # points. During the weld the station shows how far the arm is off the ideal
    # line, and the operator can stop it. Afterwards the quality system needs to
    # know whether the whole seam was done.
    #   - many_points: There are 300 points, and many points one after the other
    #     are a stream.
    #   - arms_use_it: Industrial arms accept their movements in no other way.
    #   - watched_and_stoppable: A longer movement is watched while it runs, can
    #     be stopped, and ends with a result.
    #   - seam_confirmed: The quality system needs an answer, and an answer
    #     belongs to a request.
    "weld_seam": ("", ""),
    # ---- 2. How deep is the vehicle? ----
    # A diving robot works out its depth from the water pressure, measured eight
    # times a second. The depth controller, the leak alarm and the logger need
    # it during the whole dive, and they start and stop independently of the
    # sensor.
    #   - dive_is_long: A dive takes long, and while a long task is under way
    #     one wants to be kept informed of it.
    #   - start_in_any_order: The sensor goes on telling its value, whoever
    #     listens and whenever they started.
    #   - water_is_slow: Radio does not work under water, so a pattern without
    #     replies is needed.
    #   - alarm_must_ask: The alarm has to ask for the pressure itself, to be
    #     quite sure that the value is not too high.
    "water_pressure": ("", ""),
    # ---- 3. Something touched the bumper ----
    # When a cleaning robot bumps into something, its base says so at once.
    # Several nodes react, each in its own way: one stops the brush, one draws
    # the spot into the map, one counts hits for the maker. The base does not
    # wait for any of them.
    #   - event_for_many: An event is announced to several listeners, and the
    #     sender waits for none of them.
    #   - reaction_in_steps: Stopping, drawing and counting are steps of one
    #     task that is under way.
    #   - stop_confirmed: The base has to know that the brush has stopped before
    #     it drives on.
    #   - rare_event: Hits are rare, and rare messages should be sent this way
    #     to save power.
    "bumper_hit": ("", ""),
    # ---- 4. Keeping a drone on its course ----
    # A computer on board sends the flight controller the point where the drone
    # should be, thirty times a second. When the points stop coming for half a
    # second, the controller assumes a failure and lands. No reply to a single
    # point is wanted.
    #   - wireless_link: The controller is far away, and this pattern is made
    #     for radio links.
    #   - stream_is_alive: It is a steady stream without replies, and its going
    #     on is the sign of life.
    #   - points_are_goals: Each point is a separate goal, and the drone reports
    #     when it has reached it, or why it could not.
    #   - must_be_safe: Flying is dangerous, so that the safest one of the three
    #     patterns has to be used for it.
    "drone_setpoints": ("", ""),
    # ---- 5. From GPS to field coordinates ----
    # A farmer taps on a satellite picture. The app has latitude and longitude,
    # but the robot thinks in metres from the gate of the field. Another node
    # knows the gate's position and converts one point at a time, in no time.
    #   - gps_is_sensor: Latitude and longitude come from GPS, and GPS is a
    #     sensor that sends all the time.
    #   - remote_function: It is like calling a function: one point in, and its
    #     own result back at once.
    #   - exact_numbers: The numbers must not lose digits on their way, as they
    #     could in other patterns.
    #   - robot_drives_there: The robot is going to drive there, which takes
    #     minutes and may be stopped.
    "gps_to_field": ("", ""),
    # ---- 6. Closing the fingers on an egg ----
    # A kitchen robot closes its fingers around an egg with little force, which
    # takes about three seconds. Its program watches the force on the way, opens
    # again if the egg slips, and learns at the end whether something is held or
    # the fingers met nothing.
    #   - force_is_a_value: A force has to be sent along with the order.
    #   - held_or_empty: At the end comes an answer for the program: something
    #     is held, or the fingers have met nothing.
    #   - force_readings: Force sensors deliver their readings all the time.
    #   - react_before_end: The program follows the closing for seconds, and may
    #     call it off before it ends.
    "close_gripper": ("", ""),
    # ---- 7. Saving the finished map ----
    # After a drive through a new warehouse, the engineer presses "save". The
    # map builder writes the map into a file with a given name, which takes a
    # moment. The engineer wants to read either "saved" or why it did not work.
    #   - file_is_large: A map is a large file, and writing it has to be
    #     followed from beginning to end.
    #   - short_with_answer: It is asked for now and then, is done quickly, and
    #     ends with an answer: yes, or why not.
    #   - carries_a_name: A name is handed over, and only this pattern can carry
    #     a value to the other side.
    #   - anyone_may_save: Any program that is interested should hear that
    #     somebody wants to save the map.
    "save_map": ("", ""),
    # ---- 8. A gripper learns its limits ----
    # After power-on a gripper has to drive its fingers slowly to both ends to
    # learn where they are: about ten seconds. The start-up program does other
    # things meanwhile, gives up when the fingers are blocked, and needs to know
    # whether it worked.
    #   - finger_positions: The position of the fingers changes while they move.
    #   - worked_or_not: The start-up program needs an answer in the end: either
    #     it has worked, or it has not worked.
    #   - may_be_given_up: A movement of seconds may have to be given up, while
    #     the caller does other things.
    #   - once_after_start: It is done only once after each power-on, and later
    #     never again as long as the gripper is on.
    "gripper_homing": ("", ""),
    # ---- 9. A flight along the bridge ----
    # A drone flies along a bridge on a path of 40 points: twelve minutes. The
    # pilot sees which point is next, and calls the drone back when the wind
    # gets too strong. At the end the pilot receives a note about the points
    # that the drone has reached.
    #   - known_end_can_change: It has an end that is minutes away; until then
    #     it gives news and can be called back.
    #   - wind_is_measured: The wind changes, and its speed has to be known all
    #     the time.
    #   - next_point_stream: The drone is sent its next point again and again.
    #   - final_note: At the end a note about the points that were reached is
    #     returned to the one who asked for the flight.
    "inspect_bridge": ("", ""),
    # ---- 10. Where is the tractor? ----
    # A tractor without a driver receives its position from satellites five
    # times a second. The steering uses it, a tablet in the farmhouse draws it
    # on a map, and the seeding machine writes it down. The tablet is often
    # switched off.
    #   - field_progress: The farmer wants to see how much of the field has been
    #     done already.
    #   - tablet_asks: The tablet can ask for the position whenever somebody
    #     switches it on.
    #   - independent_of_readers: Positions come one after the other, and the
    #     sender need not care who is listening.
    #   - outdoor_network: Outdoors the network is weak, and this is the only
    #     pattern that survives the loss of messages.
    "tractor_position": ("", ""),
}
