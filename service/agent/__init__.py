"""The verb ``agent``: a program on the virtual machine as an MTConnect agent."""
