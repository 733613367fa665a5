"""Speed, side by side with peers in the same run; timings never gate tests."""
