"""The registry of all actions: keys, footer, palette and help are generated from it.

A screen implements ``action_<id>`` for the actions of its scope, and ``check_action``, which tells whether an
action is available now.
"""

from cbtui.keys.action import CHECKS, CHOICE, PANES, KeyAction, Scope
from cbtui.keys.refused import NOT_ALWAYS, OWN_TIME, SIZES

_ON_A_SCREEN = (Scope.MENU, Scope.LESSON, Scope.COMPARE)
_ON_A_PANE = (Scope.LOG, Scope.CODE, Scope.CHECKS, Scope.CHOICE)
"""Scopes of a pane of a lesson, whose actions work there beside the lesson's."""
_CHOICES = (
    Scope.THREADS,
    Scope.GROUP,
    Scope.EXPORT,
    Scope.SETUP,
    Scope.DIAGNOSES,
    Scope.PREDICTION,
    Scope.SOLUTION,
    Scope.ASKING,
)
"""Scopes of windows in which no text is typed, so that the key for help works there, too."""

_Row = tuple[str, str, str, str] | tuple[str, str, str, str, str]

_FOLLOWING = "Follow the end of the log, or stay at these lines"
_PANNING = "Show an earlier or later stretch, and leave the cursor"
_LANES = "Select the lane above or below, when on the lanes"
_EVENTS = "Go to the selected lane's bar before or after the cursor"
_BARS = "Go to the clicked lane's bar before or after the cursor"
_WIDTH = "Make the pane wider or narrower; that is remembered"
_HEIGHT = "Make the pane, or the lanes, taller or lower"
_JUMP = "Show a letter on each place; type it to go there"
_PAUSING = "Pause: stop time for every thread, or let it go on"
_END = "Go back to the present; of what is over, to the end"
_AGAIN = "Put the robot back to its start, or run again"
_EXERCISE = "Do the exercise in your own file; there, back to the lesson"
_LEAVING = "End the run; go back to the menu, or to the run before it"
_OPTION = "Highlight another thread, and its line"
_OPTION_NUMBER = "Let the thread with this number go on"
_ANSWER_NUMBER = "Highlight the answer with this number"
_NO_TIME = "Say why time cannot be changed here"
_NO_SIZE = "Say why the size stays"
_PANE = f"Go to a pane: {', '.join(PANES)}"

_ROWS: dict[Scope, tuple[_Row, ...]] = {
    Scope.MENU: (
        ("open", "enter", "open", "Open the highlighted lesson or file"),
        ("previous", "up", "choose", "Highlight the one above", "Highlight another"),
        ("next", "down", "choose", "Highlight the one below", "Highlight another"),
        ("search", "/", "search", "Find a lesson or file: type its number or words"),
        ("tour", "T", "tour", "Take a tour of a minute over lesson 1"),
        ("open_file", "o", "file", "Open a program or a recording of your own"),
        ("forget", "delete", "remove", "Remove the highlighted file from the list"),
        ("end_search", "escape", "show all", "Show all lessons and files again"),
        ("jump", "j", "", _JUMP),
        ("leave", "q", "quit", "Leave the console"),
    ),
    Scope.SEARCH: (
        ("submit", "enter", "open", "Open the highlighted entry"),
        ("above", "up", "choose", "Highlight the one above", "Highlight another"),
        ("below", "down", "choose", "Highlight the one below", "Highlight another"),
        ("give_up", "escape", "show all", "Show all lessons and files again"),
    ),
    Scope.OPENING: (
        ("go", "enter", "open", "Open the file"),
        ("complete", "tab", "complete", "Complete the path"),
        ("close", "escape", "close", "Close the window without opening anything"),
    ),
    Scope.LOG: (
        ("follow", "f", "follow", "Go to the end of the log, and follow it", _FOLLOWING),
        ("stay", "f", "stay", "Stay at these lines of the log", _FOLLOWING),
        ("line_above", "up", "line", "Show the line above whole", "Show the line above or below whole"),
        ("line_below", "down", "line", "Show the line below whole", "Show the line above or below whole"),
        ("pick_line", "enter", "go there", "Move the cursor of every pane to the line's time"),
        ("copy", "y", "copy", "Copy the picked line, or those in view"),
        ("let_go", "escape", "clear", "Clear the selection; without one, the filter"),
    ),
    Scope.CODE: (
        ("line_above", "up", "line", "Go to the line above", "Go to the line above or below"),
        ("line_below", "down", "line", "Go to the line below", "Go to the line above or below"),
        ("sideways_left", "shift+left", "", "Scroll to the left", "Scroll sideways"),
        ("sideways_right", "shift+right", "", "Scroll to the right", "Scroll sideways"),
        ("pick_callback", "enter", "go to lane", "Go from the line's callback to its lane"),
        ("open_here", "o", "editor", "Open the file at the line in your editor, $EDITOR"),
        ("copy", "y", "copy", "Copy the callback at the line"),
        ("let_go", "escape", "clear", "Clear the selection, and follow what runs again"),
    ),
    Scope.CHECKS: (
        ("check_above", "up", "check", "Go to the check above", "Go to another check"),
        ("check_below", "down", "check", "Go to the check below", "Go to another check"),
        ("look_there", "enter", "go there", "Go to the moment that the check is about"),
    ),
    Scope.CHOICE: (
        *(
            (f"choose({number})", str(number), "choose", _OPTION_NUMBER, _OPTION_NUMBER)
            for number in range(1, 10)
        ),
        ("cursor_up", "up", "who", "Highlight the thread above", _OPTION),
        ("cursor_down", "down", "who", "Highlight the thread below", _OPTION),
        ("take", "enter", "choose", "Let the highlighted thread go on"),
    ),
    Scope.LESSON: (
        ("call_service", "s", "service", "Call the lesson's SetBool service with true"),
        ("call_service_off", "S", "false", "Call the lesson's SetBool service with false"),
        ("pause", "space", "pause", "Pause: stop time for every thread", _PAUSING),
        ("resume", "space", "go on", "Resume: let time go on", _PAUSING),
        ("undo", "u", "undo", "Take back the last choice of who goes on"),
        ("live", "0", "live", "Go back to the present", _END),
        ("to_end", "0", "end", "Go to the end", _END),
        ("predict", "P", "predict", "Say what you expect of the run; your answer is final"),
        ("explain", "a", "explain", "Explain what happened in the run, and why"),
        ("step", "full_stop", "step", "Go on by one decision; looking back, by one event"),
        ("run_again", "r", "run again", "Run again, when the run is over", _AGAIN),
        ("threads", "t", "threads", "Choose how many threads the executor gets, and run again"),
        ("exercise", "e", "exercise", "Do the exercise, in a file of your own", _EXERCISE),
        ("watch", "w", "watch", "Run your file again at real-time speed"),
        ("hint", "h", "hint", "Take the next hint for the exercise"),
        ("lesson", "e", "lesson", "Go from the exercise or puzzle to its lesson", _EXERCISE),
        ("next_lesson", "n", "next", "Open the next lesson"),
        ("solution", "H", "solution", "Look at the solution of the exercise or puzzle"),
        ("group", "g", "group", "Give the selected callback another group, and run again"),
        ("set_up", "p", "set-up", "Change timer periods and the rest of the set-up"),
        ("reset_world", "r", "reset", "Put the robot back to its start", _AGAIN),
        ("compare", "C", "compare", "Compare this run with the one before"),
        ("no_call_service", "s", "", "Say why no service is called"),
        ("no_call_service_off", "S", "", "Say why no service is called"),
        ("no_exercise", "e", "", "Say why there is no exercise here"),
        ("no_hint", "h", "", "Say why there is no hint now"),
        ("no_solution", "H", "", "Say why there is no solution now"),
        ("no_follow", "f", "", "Say where the log is followed"),
        ("no_compare", "C", "", "Say what can be compared"),
        *((f"no_time('{name}')", key, "", _NO_TIME) for name, key in OWN_TIME.items()),
        *((f"no_size('{name}')", key, "", _NO_SIZE) for name, key in SIZES.items()),
        ("no_take_over", "W", "", "Say when you can choose which thread goes on"),
        *(
            (f"no_use('{name}')", key, "", "Say why that key does nothing here")
            for name, key in NOT_ALWAYS.items()
        ),
        ("diagnoses", "d", "diagnoses", "List what went wrong, why, and what to do about it"),
        *(
            (f"show_pane('{name}')", str(number), "pane", f"Go to the {name}", _PANE)
            for number, name in enumerate(PANES, start=1)
        ),
        (f"show_pane('{CHECKS}')", str(len(PANES) + 1), "pane", "Go to the checks of an exercise"),
        (f"show_pane('{CHOICE}')", str(len(PANES) + 1), "pane", "Go to the choice of who goes on"),
        ("prompt", "colon", "ros2", "Type a ros2 command; tab completes it"),
        ("type", "i", "type", "Type for the program that reads from the keyboard"),
        ("filter_log", "/", "filter", "Go to the log, and filter it"),
        ("open_source", "o", "editor", "Open the code in $EDITOR; vi, emacs, code … go to its line"),
        ("record", "R", "record", "Start or stop recording the run to a file"),
        ("export", "x", "export", "Export the run so far as a picture, report, table or trace"),
        ("start_over", "ctrl+r", "start over", "End this run, and run again, at any time"),
        ("go_to_time", "G", "go to", "Go to a moment, past or future"),
        ("cycle_camera", "c", "camera", "Show the robot's map, the camera's picture, or both"),
        ("step_back", "comma", "look back", "Look at the event before the moment on screen"),
        ("earlier", "left_square_bracket", "look back", "Move the cursor of every pane back"),
        ("later", "right_square_bracket", "later", "Move the cursor of every pane on"),
        ("narrate", "N", "narrator", "Start or stop the narrator: what the executor decides, and why"),
        ("slower", "minus", "speed", "Let time pass more slowly"),
        ("faster", "plus", "speed", "Let time pass faster"),
        ("zoom_out", "less_than_sign", "zoom", "Show a longer stretch of time"),
        ("zoom_in", "greater_than_sign", "zoom", "Show a shorter stretch of time"),
        ("pan_earlier", "left", "pan", "Show an earlier stretch, and leave the cursor", _PANNING),
        ("pan_later", "right", "pan", "Show a later stretch, and leave the cursor", _PANNING),
        ("prompt_here", "enter", "ros2", "Type a ros2 command while the shell has the focus"),
        ("select", "enter", "select", "Go to the lanes and select a bar, to see what it is"),
        ("to_code", "enter", "code", "Go from the selected bar to its code"),
        ("lane_above", "up", "lane", "Select the lane above", _LANES),
        ("lane_below", "down", "lane", "Select the lane below", _LANES),
        (
            "previous_event",
            "left_curly_bracket",
            "bar",
            "Go back to the selected lane's previous bar",
            _EVENTS,
        ),
        ("next_event", "right_curly_bracket", "bar", "Go on to the selected lane's next bar", _EVENTS),
        ("deselect", "escape", "leave", "Leave the lanes, and clear the selection"),
        ("copy_details", "y", "copy", "Copy the selected bar's details, or the moment's"),
        ("next_pane", "tab", "next pane", "Go to the next pane"),
        ("jump", "j", "jump", _JUMP),
        ("maximise", "z", "enlarge", "Enlarge one pane; press again to go back"),
        ("enlarge_lanes", "Z", "enlarge", "Enlarge the lanes; press again to go back"),
        ("wider", "ctrl+right", "size", "Give the pane more columns", _WIDTH),
        ("narrower", "ctrl+left", "size", "Give the pane fewer columns", _WIDTH),
        ("taller", "ctrl+up", "size", "Give the pane, or the lanes, more rows", _HEIGHT),
        ("lower", "ctrl+down", "size", "Give the pane, or the lanes, fewer rows", _HEIGHT),
        ("usual_sizes", "equals_sign", "usual sizes", "Give lanes and panes their usual sizes"),
        ("chain", "k", "chain", "Follow messages between topics: their path on the lanes"),
        ("take_over", "W", "choose", "From a paused moment on, choose which thread goes on"),
        ("leave", "q", "menu", "End the run and go back to the menu", _LEAVING),
        ("go_back", "q", "back", "End the run and go back to the run that led here", _LEAVING),
    ),
    Scope.COMPARE: (
        ("window", "w", "whole or screen", "Let the table cover whole runs, or only what is on screen"),
        ("scroll_table_up", "up", "scroll", "Scroll the table up"),
        ("scroll_table_down", "down", "scroll", "Scroll the table down"),
        ("page_up", "pageup", "", "Scroll the table up by a page"),
        ("page_down", "pagedown", "", "Scroll the table down by a page"),
        ("maximise", "z", "table", "Enlarge the table; press again to go back"),
        ("earlier", "left_square_bracket", "cursor", "Move the cursor back"),
        ("later", "right_square_bracket", "cursor", "Move the cursor on"),
        ("pan_earlier", "left", "pan", "Show an earlier stretch, and leave the cursor", _PANNING),
        ("pan_later", "right", "pan", "Show a later stretch, and leave the cursor", _PANNING),
        ("previous_event", "left_curly_bracket", "bar", "Go back to the lane's previous bar", _BARS),
        ("next_event", "right_curly_bracket", "bar", "Go on to the lane's next bar", _BARS),
        ("deselect", "escape", "deselect", "Clear the selection"),
        ("zoom_out", "less_than_sign", "zoom", "Show a longer stretch of time"),
        ("zoom_in", "greater_than_sign", "zoom", "Show a shorter stretch of time"),
        ("go_to_time", "G", "go to", "Go to a moment"),
        ("to_end", "0", "end", "Go to the end"),
        ("enlarge_lanes", "Z", "lanes", "Enlarge the lanes; press again to go back"),
        ("step_back", "comma", "event", "Go to the previous event, of either run"),
        ("step", "full_stop", "event", "Go to the next event, of either run"),
        ("jump", "j", "", _JUMP),
        ("leave", "q", "back", "Leave the comparison"),
    ),
    Scope.FILTER: (
        ("submit", "enter", "keep", "Keep the filter, and go to its lines"),
        ("drop_filter", "escape", "clear", "Show every line again"),
    ),
    Scope.PROMPT: (
        ("submit", "enter", "run", "Run the line"),
        ("complete", "tab", "complete", "Complete the word at the cursor"),
        ("older", "up", "lines before", "Bring back the line before"),
        ("newer", "down", "lines before", "Go on to the line after"),
        ("interrupt", "ctrl+c", "interrupt", "Interrupt the running line"),
        ("leave_prompt", "escape", "other keys", "Go back to the other keys"),
    ),
    Scope.KEYBOARD: (
        ("submit", "enter", "send", "Send the line to the program"),
        ("interrupt", "ctrl+c", "interrupt", "Interrupt the program, as in any terminal"),
        (
            "leave_keyboard",
            "ctrl+right_square_bracket",
            "other keys",
            "Go back to the other keys of the console",
        ),
    ),
    Scope.THREADS: (
        *(
            (f"choose({number})", str(number), "threads", f"Run with {number} threads")
            for number in range(1, 9)
        ),
        ("choose(0)", "o", "the program's own", "Run with the program's own number"),
        ("close", "escape,q", "close", "Close the window, and change nothing"),
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
        ("choose('')", "p", "the program's", "Use the group that the program gives it"),
        ("close", "escape,q", "close", "Close the window, and change nothing"),
    ),
    Scope.EXPORT: (
        *(
            (f"choose('{name}')", key, "format", f"Export {what}")
            for key, name, what in (
                ("p", "picture", "a picture of the stretch on screen"),
                ("w", "whole", "a picture of the whole run"),
                ("r", "report", "a report"),
                ("h", "html", "a page that plays the run in any browser"),
                ("t", "table", "a table of the calls"),
                ("u", "perfetto", "a trace for ui.perfetto.dev"),
                ("c", "chrome", "a trace for chrome://tracing and Speedscope"),
            )
        ),
        ("close", "escape,q", "close", "Close the window, and export nothing"),
    ),
    Scope.SETUP: (
        ("change", "enter", "change", "Change what is highlighted"),
        ("run", "r", "run with it", "Run again with the changes"),
        ("undo_all", "u", "undo all", "Undo every change"),
        ("close", "escape,q", "close", "Close the window, and change nothing"),
    ),
    Scope.DIAGNOSES: (
        ("previous", "up", "choose", "Highlight the one above", "Highlight another"),
        ("next", "down", "choose", "Highlight the one below", "Highlight another"),
        ("go", "enter", "go there", "Go to the moment and the code"),
        ("open_lesson", "enter", "open the lesson", "Open the lesson that shows the problem"),
        ("try_this", "enter", "try the cure", "Run again with the highlighted cure, and compare"),
        ("try_cure", "t", "try the cure", "Run again with the cure, and compare with the run before"),
        ("page_up", "pageup", "scroll", "Scroll the text up"),
        ("page_down", "pagedown", "scroll", "Scroll the text down"),
        ("close", "escape,q", "close", "Close the window, and stay where you are"),
    ),
    Scope.PREDICTION: (
        *(
            (f"choose({number})", str(number), "choose", f"Highlight answer {number}", _ANSWER_NUMBER)
            for number in range(1, 6)
        ),
        ("previous", "up", "choose", "Highlight the one above", "Highlight another"),
        ("next", "down", "choose", "Highlight the one below", "Highlight another"),
        ("take", "enter", "answer", "Give the highlighted answer; it is final"),
        ("no_take", "enter", "", "Say that an answer has to be chosen first"),
        ("skip", "escape", "without predicting", "Go on without predicting"),
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
        ("close", "escape,q", "not yet", "Close the window"),
    ),
    Scope.VALUE: (
        ("go", "enter", "take", "Take the value"),
        ("close", "escape", "close", "Close the window, and keep the value"),
    ),
    Scope.MOMENT: (
        ("go", "enter", "go", "Go to the moment"),
        ("close", "escape", "close", "Close the window, and stay where you are"),
    ),
    Scope.CHAIN: (
        ("go", "enter", "follow", "Follow the chain"),
        ("close", "escape", "close", "Close the window, and follow what was followed before"),
    ),
    Scope.HELP: (
        ("line_up", "up", "scroll", "Scroll up by a line", "Scroll by a line"),
        ("line_down", "down", "scroll", "Scroll down by a line", "Scroll by a line"),
        ("page_up", "pageup", "", "Scroll up by a page", "Scroll by a page"),
        ("page_down", "pagedown", "", "Scroll down by a page", "Scroll by a page"),
        ("next_heading", "tab", "next heading", "Go on to the next heading"),
        ("search", "/", "search", "Show only signs and keys that have certain words"),
        ("close", "escape,q,question_mark", "close", "Go back to where you were"),
    ),
    Scope.TOUR: (
        ("next", "enter,right,space", "next", "Go to the next stop"),
        ("previous", "left,backspace", "back", "Go back to the stop before"),
        ("close", "escape", "or another key: on with the lesson", "Leave the tour, as other keys do"),
    ),
    Scope.JUMP: (("close", "escape", "leave, a letter goes there", "Leave without going anywhere"),),
    Scope.EVERYWHERE: (
        ("command_palette", "ctrl+p", "commands", "Find any command, and colour themes"),
        ("help", "question_mark", "help", "Show every key and what it does"),
    ),
}
"""The other fields of each scope's actions, in the order of ``KeyAction``."""

ACTIONS = tuple(KeyAction(scope, *row) for scope, rows in _ROWS.items() for row in rows)


TASKS = {
    task: tuple(names.split())
    for task, names in {
        "Learn": "predict explain exercise lesson watch hint solution next_lesson leave go_back",
        "Act on the run": (
            "call_service call_service_off prompt prompt_here type reset_world run_again start_over undo "
            "take_over"
        ),
        "Time": (
            "pause resume step step_back narrate slower faster earlier later go_to_time live to_end zoom_in "
            "zoom_out pan_earlier pan_later"
        ),
        "Ask why": (
            "diagnoses chain select lane_above lane_below previous_event next_event to_code copy_details "
            "deselect"
        ),
        "Change something and compare": "threads group set_up compare",
        "Panes": (
            "show_pane next_pane jump maximise enlarge_lanes wider narrower taller lower usual_sizes "
            "cycle_camera filter_log"
        ),
        "Files": "open_source record export",
    }.items()
}
"""A lesson's actions by what they are for, in the order of the help."""


def actions_of(scope: Scope) -> tuple[KeyAction, ...]:
    """Return the actions that work in a scope, on a pane also those of its lesson.

    Actions of ``EVERYWHERE`` are left out while text is typed, and in windows all but help.
    """
    if scope in _ON_A_PANE:
        scopes: tuple[Scope, ...] = (scope, Scope.LESSON, Scope.EVERYWHERE)
    else:
        scopes = (scope, Scope.EVERYWHERE) if scope in _ON_A_SCREEN else (scope,)
    more = ("help",) if scope in _CHOICES else ()
    return tuple(action for action in ACTIONS if action.scope in scopes or action.id in more)
