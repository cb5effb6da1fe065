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
    "live": "0",
    "undo": "u",
    "watch": "w",
    "chain": "k",
    "type": "i",
    "export": "x",
    "usual_sizes": "equals_sign",
}
"""Actions that make no sense for some of what a run's screen shows, such as a recording."""
_BEGINNING, _END = "This is the beginning of the runs.", "This is the end of the runs."
NOT_IN_COMPARISON = {
    "select": ("enter", "Code is shown beside a run: a comparison has only lanes and figures."),
    "diagnoses": ("d", "Diagnoses are listed in a run; what is gone or new is told at the top."),
    "previous_event": ("left_curly_bracket", "No bar is earlier on this lane."),
    "next_event": ("right_curly_bracket", "No bar is later on this lane."),
    "earlier": ("left_square_bracket", _BEGINNING),
    "later": ("right_square_bracket", _END),
    "pan_earlier": ("left", _BEGINNING),
    "pan_later": ("right", _END),
    "step_back": ("comma", _BEGINNING),
    "step": ("full_stop", _END),
    "zoom_in": ("greater_than_sign", "This is the shortest stretch."),
    "zoom_out": ("less_than_sign", "This is the longest stretch."),
}
"""Actions that a comparison has not, or that lead nowhere at an end of the runs; with keys and reasons."""
