"""What a node has: publishers, subscriptions, timers, services, clients, guard conditions, events."""
