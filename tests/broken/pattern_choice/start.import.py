from course_kits import choose

answers = choose()
