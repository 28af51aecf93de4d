"""A thin program around a node of nodes.py."""

from nodes import Door, run

if __name__ == "__main__":
    run(Door)
