"""The entities of a node: publishers, subscriptions, timers, services, clients, guard conditions, events."""
