"""The running half of the lab: the executor thread, the nodes on it, the execution of goals."""
