answers = {}
answers["weld_seam"] = ('action', 'watched_and_stoppable')
answers["water_pressure"][0] = "topic"
