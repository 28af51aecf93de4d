"""Threads publish on one publisher while others call a service and an executor takes; run as a program."""

from __future__ import annotations

import faulthandler
import sys
import threading

faulthandler.dump_traceback_later(90, exit=True)  # a hang ends with a stack trace
sys.setswitchinterval(1e-5)

import rclpy  # noqa: E402 - first the switch interval
from example_interfaces.msg import Float64MultiArray, MultiArrayDimension, MultiArrayLayout  # noqa: E402
from example_interfaces.srv import AddTwoInts  # noqa: E402
from rclpy.callback_groups import ReentrantCallbackGroup  # noqa: E402
from rclpy.executors import MultiThreadedExecutor  # noqa: E402

rclpy.init()
node, group = rclpy.create_node("threads"), ReentrantCallbackGroup()
layout = MultiArrayLayout(dim=[MultiArrayDimension(label="x" * 100)])
publisher = node.create_publisher(Float64MultiArray, "array", 10)
node.create_subscription(Float64MultiArray, "array", lambda _: None, 10, callback_group=group)


def add(request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
    response.sum = request.a + request.b
    return response


node.create_service(AddTwoInts, "add", add, callback_group=group)
client = node.create_client(AddTwoInts, "add", callback_group=group)
executor = MultiThreadedExecutor(4)
executor.add_node(node)
stopping = threading.Event()


def spin() -> None:
    while not stopping.is_set():  # rclpy's own spin() may miss the one wake-up that shutdown() gives, and wait on
        executor.spin_once(timeout_sec=0.1)


spinning = threading.Thread(target=spin)
spinning.start()
published, answered = [], []


def publish() -> None:
    for i in range(2000):
        publisher.publish(Float64MultiArray(layout=layout, data=[float(i)] * 20))
        published.append(i)


def call() -> None:
    for i in range(200):
        done = threading.Event()
        future = client.call_async(AddTwoInts.Request(a=i, b=1))
        future.add_done_callback(lambda _, done=done: done.set())
        if done.wait(20) and future.result().sum == i + 1:
            answered.append(i)


workers = [threading.Thread(target=publish) for _ in range(4)] + [threading.Thread(target=call) for _ in range(2)]
if not client.wait_for_service(20):
    sys.exit("waited 20 s for the service")
for worker in workers:
    worker.start()
for worker in workers:
    worker.join()
sys.stdout.write(f"published {len(published)}, answered {len(answered)}\n")
stopping.set()
spinning.join()
executor.shutdown()
node.destroy_node()
rclpy.shutdown()
