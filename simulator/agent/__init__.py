"""MTConnect agent of the virtual machine: device models, observations, documents, HTTP."""
