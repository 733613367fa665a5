"""A program under the force control loop."""
