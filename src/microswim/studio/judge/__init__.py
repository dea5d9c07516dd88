"""What takes seconds or more and is done in a process of its own: references, flow, paths."""
