thoughts = []
while True:
    thoughts.append(bytearray(10_000_000))
    answers = dict.fromkeys(range(len(thoughts)))
