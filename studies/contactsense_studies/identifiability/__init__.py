"""What the joint torques of a robot tell of contacts: how exactly a point is known, link by link."""
