"""The registry of all actions: keys, footer, palette and help are generated from it.

A screen implements ``action_<id>`` for the actions of its scope, and ``check_action``, which tells whether an
action is available now.
"""

from cbtui.keys.action import CHECKS, PANES, KeyAction, Scope

_ON_A_SCREEN = (Scope.MENU, Scope.LESSON, Scope.COMPARE)
_ON_A_PANE = (Scope.LOG, Scope.CODE, Scope.CHECKS)
"""Scopes of a pane of a lesson, whose actions work there beside the lesson's."""

_Row = tuple[str, str, str, str] | tuple[str, str, str, str, str]

_FOLLOWING = "Follow the end of the log, or stay at these lines"
_PANNING = "Show an earlier or later stretch, and leave the cursor"
_LANES = "Select the lane above or below, when on the lanes"
_EVENTS = "Go to the selected lane's bar before or after the cursor"
_BARS = "Go to the clicked lane's bar before or after the cursor"
_LESSON_NUMBER = "Open the lesson with this number"
_ANSWER_NUMBER = "Highlight the answer with this number"
_PANE = f"Go to a pane: {', '.join(PANES)}"

_ROWS: dict[Scope, tuple[_Row, ...]] = {
    Scope.MENU: (
        ("open", "enter", "open", "Open the highlighted lesson or file"),
        *(
            (f"open_number({number})", str(number), "open", f"Open lesson {number}", _LESSON_NUMBER)
            for number in range(1, 10)
        ),
        ("previous", "up", "choose", "Highlight what is above", "Highlight another"),
        ("next", "down", "choose", "Highlight what is below", "Highlight another"),
        ("search", "/", "search", "Show only lessons and files that have some words"),
        ("open_file", "o", "file", "Open a program or a recording of your own"),
        ("forget", "delete", "take off", "Take the highlighted file off the list"),
        ("end_search", "escape", "show all", "Show all lessons and files again"),
        ("leave", "q", "quit", "Leave the console"),
    ),
    Scope.SEARCH: (
        ("submit", "enter", "open", "Open what is highlighted"),
        ("above", "up", "choose", "Highlight what is above", "Highlight another"),
        ("below", "down", "choose", "Highlight what is below", "Highlight another"),
        ("give_up", "escape", "show all", "Show all lessons and files again"),
    ),
    Scope.OPENING: (
        ("go", "enter", "open", "Open the file"),
        ("complete", "tab", "complete", "Complete the path as far as there is one way"),
        ("close", "escape", "close", "Close the window, and open nothing"),
    ),
    Scope.LOG: (
        ("filter", "/", "filter", "Show some lines only, by words, level or writer"),
        ("follow", "f", "follow", "Go to the end of the log, and follow it", _FOLLOWING),
        ("stay", "f", "stay", "Stay at these lines of the log", _FOLLOWING),
        ("line_above", "up", "line", "Pick the line above", "Pick the line above or below"),
        ("line_below", "down", "line", "Pick the line below", "Pick the line above or below"),
        ("pick_line", "enter", "go there", "Move the cursor of every pane to the line's time"),
        ("copy", "y", "copy", "Copy the picked line, or those in view"),
        ("let_go", "escape", "let go", "Have no line picked"),
    ),
    Scope.CODE: (
        ("line_above", "up", "line", "Go to the line above", "Go to the line above or below"),
        ("line_below", "down", "line", "Go to the line below", "Go to the line above or below"),
        ("pick_callback", "enter", "go to lane", "Go from the line's callback to its lane"),
        ("open_here", "o", "editor", "Open the file at the line in $EDITOR"),
        ("copy", "y", "copy", "Copy the callback at the line"),
        ("let_go", "escape", "let go", "Pick no line, and go to what runs again"),
    ),
    Scope.CHECKS: (
        ("check_above", "up", "check", "Go to the check above", "Go to another check"),
        ("check_below", "down", "check", "Go to the check below", "Go to another check"),
        ("look_there", "enter", "look there", "Go to the moment that the check speaks of"),
    ),
    Scope.LESSON: (
        ("call_service", "s", "service", "Call the lesson's SetBool service with true"),
        ("call_service_off", "S", "false", "Call the lesson's SetBool service with false"),
        ("pause", "space", "pause", "Stop time for every thread"),
        ("resume", "space", "go on", "Let time go on"),
        ("live", "0", "live", "Go back to the present"),
        ("predict", "P", "predict", "Say what you expect of the run; a given answer stays"),
        ("explain", "a", "explain", "Tell what the run shows to be true, and why"),
        ("step", "full_stop", "step", "Go on by one decision, in a pause; looking back, by one event"),
        ("run_again", "r", "run again", "Run again, when the run is over"),
        ("threads", "t", "threads", "Choose how many threads the executor gets, and run again"),
        ("exercise", "e", "exercise", "Do the exercise, in a file of your own in the current folder"),
        ("watch", "w", "watch", "Run your file again at the pace of real time"),
        ("hint", "h", "hint", "Take the next hint for the exercise"),
        ("lesson", "e", "lesson", "Go from the exercise back to its lesson"),
        ("next_lesson", "n", "next", "Open the next lesson"),
        ("solution", "H", "solution", "Look at the solution of the exercise"),
        ("group", "g", "group", "Give the selected callback another group, and run again"),
        ("set_up", "p", "set-up", "Change timers' periods and all else of the set-up"),
        ("reset_world", "r", "reset", "Put the robot back to its start"),
        ("compare", "C", "compare", "Compare this run with the one before"),
        ("diagnoses", "d", "diagnoses", "List what goes wrong in this run, why, and what to do about it"),
        *(
            (f"show_pane('{name}')", str(number), "pane", f"Go to the {name}", _PANE)
            for number, name in enumerate(PANES, start=1)
        ),
        (f"show_pane('{CHECKS}')", str(len(PANES) + 1), "pane", "Go to the checks of an exercise"),
        ("prompt", "colon", "ros2", "Type a ros2 line; tab completes, up brings lines back"),
        ("type", "i", "type", "Type for the program that reads from the keyboard"),
        ("filter_log", "/", "filter", "Go to the log, and filter it"),
        ("open_source", "o", "editor", "Open the code in $EDITOR"),
        ("record", "R", "record", "Begin a recording of the run in the current folder, or end it"),
        ("export", "x", "export", "Make a picture, a report, a table or a trace of the run so far"),
        ("start_over", "ctrl+r", "start over", "End this run, and run again, at any time"),
        ("go_to_time", "G", "go to", "Look back at a moment, or run on until it has come"),
        ("cycle_camera", "c", "camera", "Show the robot's map, the camera's picture, or both"),
        ("step_back", "comma", "look back", "Look at the event before the moment on screen"),
        ("earlier", "left_square_bracket", "look back", "Move the cursor of every pane back"),
        ("later", "right_square_bracket", "look back", "Move the cursor of every pane on"),
        ("slower", "minus", "speed", "Let time pass more slowly"),
        ("faster", "plus", "speed", "Let time pass faster"),
        ("zoom_out", "less_than_sign", "zoom", "Show a longer stretch of time"),
        ("zoom_in", "greater_than_sign", "zoom", "Show a shorter stretch of time"),
        ("pan_earlier", "left", "pan", "Show an earlier stretch, and leave the cursor", _PANNING),
        ("pan_later", "right", "pan", "Show a later stretch, and leave the cursor", _PANNING),
        ("select", "enter", "select", "Go to the lanes and select a bar, to see what it is"),
        ("to_code", "enter", "code", "Go from the selected bar to its code"),
        ("lane_above", "up", "lane", "Select the lane above", _LANES),
        ("lane_below", "down", "lane", "Select the lane below", _LANES),
        (
            "previous_event",
            "left_curly_bracket",
            "event",
            "Go back to the selected lane's bar before",
            _EVENTS,
        ),
        ("next_event", "right_curly_bracket", "event", "Go on to the selected lane's next bar", _EVENTS),
        ("deselect", "escape", "deselect", "Leave the lanes, and select nothing"),
        ("copy_details", "y", "copy", "Copy the selected bar's details, or else the moment's, as text"),
        ("next_pane", "tab", "next pane", "Go to the next pane"),
        ("maximise", "z", "enlarge", "Let one pane fill the screen; press again to go back"),
        ("enlarge_lanes", "Z", "enlarge", "Let the lanes fill the screen; press again to go back"),
        ("leave", "q", "menu", "End the run and go back to the menu"),
    ),
    Scope.COMPARE: (
        ("window", "w", "whole or screen", "Let the table tell of whole runs, or of what is on screen"),
        ("earlier", "left_square_bracket", "look back", "Move the cursor back"),
        ("later", "right_square_bracket", "look back", "Move the cursor on"),
        ("pan_earlier", "left", "pan", "Show an earlier stretch, and leave the cursor", _PANNING),
        ("pan_later", "right", "pan", "Show a later stretch, and leave the cursor", _PANNING),
        ("previous_event", "left_curly_bracket", "bar", "Go back to the lane's bar before", _BARS),
        ("next_event", "right_curly_bracket", "bar", "Go on to the lane's next bar", _BARS),
        ("deselect", "escape", "deselect", "Select nothing"),
        ("zoom_out", "less_than_sign", "zoom", "Show a longer stretch of time"),
        ("zoom_in", "greater_than_sign", "zoom", "Show a shorter stretch of time"),
        ("go_to_time", "G", "go to", "Go to a moment"),
        ("live", "0", "end", "Go to the end"),
        ("maximise", "z", "table", "Let the table fill the screen; press again to go back"),
        ("enlarge_lanes", "Z", "lanes", "Let the lanes fill the screen; press again to go back"),
        ("scroll_table_up", "up", "scroll", "Show what lies above in the table"),
        ("scroll_table_down", "down", "scroll", "Show what lies below in the table"),
        ("step_back", "comma", "event", "Go to the event before, of either run"),
        ("step", "full_stop", "event", "Go to the next event, of either run"),
        ("leave", "q", "back", "Leave the comparison"),
    ),
    Scope.FILTER: (
        ("submit", "enter", "keep", "Go to the lines that the filter lets through"),
        ("drop_filter", "escape", "clear", "Show every line again"),
    ),
    Scope.PROMPT: (
        ("submit", "enter", "run", "Carry out the line"),
        ("complete", "tab", "complete", "Complete the word at the cursor"),
        ("older", "up", "lines before", "Bring back the line before"),
        ("newer", "down", "lines before", "Go on to the line after"),
        ("interrupt", "ctrl+c", "interrupt", "End the line that goes on"),
        ("leave_prompt", "escape", "other keys", "Go back to the other keys"),
    ),
    Scope.KEYBOARD: (
        ("submit", "enter", "give", "Give the line to the program that reads it"),
        ("interrupt", "ctrl+c", "interrupt", "Interrupt the program, as in any terminal"),
        (
            "leave_keyboard",
            "ctrl+right_square_bracket",
            "other keys",
            "Go back to the other keys; the program gets every other key where it takes single ones",
        ),
    ),
    Scope.THREADS: (
        *(
            (f"choose({number})", str(number), "threads", f"Run with {number} threads")
            for number in range(1, 9)
        ),
        ("choose(0)", "o", "the program's own", "Run with the program's own number"),
        ("close", "escape,q", "close", "Close the window, and leave everything as it is"),
    ),
    Scope.GROUP: (
        *(
            (f"choose('{name}')", key, "group", f"Give it {group}")
            for key, name, group in (
                ("o", "own", "a group of its own"),
                ("s", "shared", "the shared group"),
                ("r", "reentrant", "the reentrant group"),
                ("d", "default", "the node's default group"),
            )
        ),
        ("choose('')", "p", "the program's", "Give it the group that the program says"),
        ("close", "escape,q", "close", "Close the window, and leave everything as it is"),
    ),
    Scope.EXPORT: (
        *(
            (f"choose('{name}')", key, "format", f"Export {what}")
            for key, name, what in (
                ("p", "picture", "a picture of the stretch on screen"),
                ("w", "whole", "a picture of the whole run"),
                ("r", "report", "a report"),
                ("t", "table", "a table of the calls"),
                ("u", "perfetto", "a trace for ui.perfetto.dev"),
                ("c", "chrome", "a trace for chrome://tracing and Speedscope"),
            )
        ),
        ("close", "escape,q", "close", "Close the window, and export nothing"),
    ),
    Scope.SETUP: (
        ("change", "enter", "change", "Change what is highlighted"),
        ("run", "r", "run with it", "Run again with what is changed"),
        ("undo_all", "u", "undo all", "Have everything as the program says"),
        ("close", "escape,q", "close", "Close the window, and let the run go on as it is"),
    ),
    Scope.DIAGNOSES: (
        ("previous", "up", "choose", "Highlight what is above", "Highlight another"),
        ("next", "down", "choose", "Highlight what is below", "Highlight another"),
        ("go", "enter", "go there", "Go to the moment and to the code"),
        ("close", "escape,q", "close", "Close the window, and stay where you are"),
    ),
    Scope.PREDICTION: (
        *(
            (f"choose({number})", str(number), "choose", f"Highlight answer {number}", _ANSWER_NUMBER)
            for number in range(1, 6)
        ),
        ("previous", "up", "choose", "Highlight what is above", "Highlight another"),
        ("next", "down", "choose", "Highlight what is below", "Highlight another"),
        ("take", "enter", "answer", "Give the highlighted answer, for good"),
        ("skip", "escape", "without predicting", "Go on without an answer"),
        ("page_up", "pageup", "scroll", "Scroll the text up"),
        ("page_down", "pagedown", "scroll", "Scroll the text down"),
        ("close", "q", "back", "Go back to where you came from"),
    ),
    Scope.SOLUTION: (
        ("show_whole", "d", "whole file", "Show the whole solution"),
        ("show_difference", "d", "what differs", "Show only what differs"),
        ("close", "escape,q", "close", "Close the window"),
    ),
    Scope.ASKING: (
        ("take", "enter", "look at it", "Look at the solution"),
        ("close", "escape,q", "not yet", "Close the window, and look at nothing"),
    ),
    Scope.NUMBER: (
        ("go", "enter", "take", "Take the number"),
        ("close", "escape", "close", "Close the window, and leave the number as it is"),
    ),
    Scope.MOMENT: (
        ("go", "enter", "go", "Go to the moment"),
        ("close", "escape", "close", "Close the window, and stay where you are"),
    ),
    Scope.HELP: (("close", "escape,q,question_mark", "close", "Go back to where you were"),),
    Scope.EVERYWHERE: (
        ("command_palette", "ctrl+p", "commands", "Find any command, and colour themes"),
        ("help", "question_mark", "help", "Show every key and what it does"),
    ),
}
"""The other fields of each scope's actions, in the order of ``KeyAction``."""

ACTIONS = tuple(KeyAction(scope, *row) for scope, rows in _ROWS.items() for row in rows)


def actions_of(scope: Scope) -> tuple[KeyAction, ...]:
    """Return the actions that work in a scope, on a pane also those of its lesson.

    Actions of ``EVERYWHERE`` are left out in windows and while text is typed.
    """
    if scope in _ON_A_PANE:
        scopes: tuple[Scope, ...] = (scope, Scope.LESSON, Scope.EVERYWHERE)
    else:
        scopes = (scope, Scope.EVERYWHERE) if scope in _ON_A_SCREEN else (scope,)
    return tuple(action for action in ACTIONS if action.scope in scopes)
