"""The actions that say why they do nothing where they make no sense; with their keys."""

OWN_TIME = {
    "pause": "space",
    "resume": "space",
    "step": "full_stop",
    "slower": "minus",
    "faster": "plus",
    "take_over": "W",
}
"""The actions that need a time that can be stopped, as real ROS 2's cannot."""
NOT_ALWAYS = {
    **OWN_TIME,
    "step_back": "comma",
    "threads": "t",
    "group": "g",
    "set_up": "p",
    "predict": "P",
    "next_lesson": "n",
    "explain": "a",
    "hint": "h",
    "compare": "C",
    "cycle_camera": "c",
    "reset_world": "r",
    "call_service": "s",
    "call_service_off": "S",
    "prompt": "colon",
    "record": "R",
}
"""Actions that make no sense for some of what a run's screen shows, such as a recording."""
