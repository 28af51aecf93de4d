answers = {}
while not answers:
    print('topic, service or action?')
