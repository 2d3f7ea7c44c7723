"""A page in the browser that shows the robot with what is felt."""
