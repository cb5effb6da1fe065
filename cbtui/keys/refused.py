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
    "earlier": "left_square_bracket",
    "later": "right_square_bracket",
    "previous_event": "left_curly_bracket",
    "next_event": "right_curly_bracket",
    "zoom_out": "less_than_sign",
    "zoom_in": "greater_than_sign",
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
NOT_IN_COMPARISON = {
    "select": "enter",
    "diagnoses": "d",
    "previous_event": "left_curly_bracket",
    "next_event": "right_curly_bracket",
    "earlier": "left_square_bracket",
    "later": "right_square_bracket",
    "pan_earlier": "left",
    "pan_later": "right",
    "step_back": "comma",
    "step": "full_stop",
    "zoom_in": "greater_than_sign",
    "zoom_out": "less_than_sign",
}
"""Actions that a comparison has not, or that lead nowhere at an end of the runs."""
