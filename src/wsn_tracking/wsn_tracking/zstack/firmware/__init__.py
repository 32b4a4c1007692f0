"""What is inside a simulated sink: TI's firmware as a host sees it, without radio and without a serial line."""
