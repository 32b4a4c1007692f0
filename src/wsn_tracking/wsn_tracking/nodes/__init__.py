"""One file an executable: the only room that knows rclpy."""
