"""One module a command; each adds its verbs to the parser and is imported only when its command is used."""
