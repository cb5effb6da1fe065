"""The machine: host, processes, network and deliveries; it knows endpoints by small protocols."""
