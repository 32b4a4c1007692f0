"""What is assumed of the world: motion, noise, radio, measurement functions."""
