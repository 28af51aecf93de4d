"""How the kit starts, supervises and ends other processes."""
