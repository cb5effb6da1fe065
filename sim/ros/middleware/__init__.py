"""The machine: host, processes, network, and what is on its way; knows endpoints by small protocols."""
