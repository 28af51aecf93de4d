"""What crossed the wire between nodes, and its sequence diagram."""
