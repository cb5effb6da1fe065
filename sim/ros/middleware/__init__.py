"""The simulated machine: host, processes, network and deliveries. It knows endpoints only by protocols."""
