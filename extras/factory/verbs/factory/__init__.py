"""Run a shop: batches through machines, with times, states and energy.

With --live the shop runs at a pace until it is interrupted, each machine as a device of one
MTConnect agent.
"""
