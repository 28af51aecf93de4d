"""The mistakes that `prove` makes in a solution, each a function from a program to its changes."""
