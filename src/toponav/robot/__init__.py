"""TopoNav on a continuous robot: poses, frames, motion and safety, free of any middleware.

`ros2_node` and `sim_robot` alone import rclpy.
"""
