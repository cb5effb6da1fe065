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
SIZES = {"wider": "ctrl+right", "narrower": "ctrl+left", "taller": "ctrl+up", "lower": "ctrl+down"}
"""The actions that need room in the layout."""
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
_ALL_SHOWN = "There are no more rows to scroll to."
NOT_IN_COMPARISON = {
    "select": "Code is shown beside a run: a comparison has only lanes and figures.",
    "diagnoses": "Diagnoses are listed in a run; what is gone or new is told at the top.",
    "previous_event": "No bar is earlier on this lane.",
    "next_event": "No bar is later on this lane.",
    "earlier": _BEGINNING,
    "later": _END,
    "pan_earlier": _BEGINNING,
    "pan_later": _END,
    "step_back": _BEGINNING,
    "step": _END,
    "deselect": "No bar is selected that could be cleared; q goes back.",
    "zoom_in": "This is the shortest stretch.",
    "zoom_out": "This is the longest stretch.",
    "scroll_table_up": _ALL_SHOWN,
    "scroll_table_down": _ALL_SHOWN,
    "page_up": _ALL_SHOWN,
    "page_down": _ALL_SHOWN,
}
"""Why an action leads nowhere in a comparison, which says of other actions that only a run has them."""
NOT_IN_DIAGNOSES = {
    "previous": "there is only one row",
    "next": "there is only one row",
    "go": "this is about no moment and no line",
    "try_cure": "no cure of this has proved to help so far",
    "page_up": "all of the text is on screen",
    "page_down": "all of the text is on screen",
}
"""Why an action of the window of diagnoses does nothing."""
