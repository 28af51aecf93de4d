import threading
import time

answers = {}
for _ in range(200):
    threading.Thread(target=time.sleep, args=(30,), daemon=True).start()
    answers[len(answers)] = ()
