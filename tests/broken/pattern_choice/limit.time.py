answers = {}
while len(answers) < 10:
    answers.clear()
