"""The registry of all actions: keys, footer, palette and help are generated from it.

A screen implements ``action_<id>`` for the actions of its scope, and ``check_action``, which tells whether an
action is available now.
"""

from cbtui.keys.action import CHECKS, PANES, Action, Scope

_ALONE = (
    Scope.SEARCH,
    Scope.OPENING,
    Scope.FILTER,
    Scope.PROMPT,
    Scope.KEYBOARD,
    Scope.THREADS,
    Scope.GROUP,
    Scope.EXPORT,
    Scope.SETUP,
    Scope.DIAGNOSES,
    Scope.PREDICTION,
    Scope.SOLUTION,
    Scope.ASKING,
    Scope.NUMBER,
    Scope.MOMENT,
    Scope.HELP,
)
_ON_A_PANE = (Scope.LOG, Scope.CODE, Scope.CHECKS)
"""Scopes of a pane of a lesson, whose actions work there beside the lesson's."""


ACTIONS = (
    Action("open", "enter", "open", "Open the highlighted lesson or file", Scope.MENU),
    *(
        Action(
            f"open_number({number})",
            str(number),
            "open",
            f"Open lesson {number}",
            Scope.MENU,
            "Open the lesson with this number",
        )
        for number in range(1, 10)
    ),
    Action("previous", "up", "choose", "Highlight what is above", Scope.MENU, "Highlight another"),
    Action("next", "down", "choose", "Highlight what is below", Scope.MENU, "Highlight another"),
    Action("search", "/", "search", "Show only lessons and files that have some words", Scope.MENU),
    Action("open_file", "o", "file", "Open a program or a recording of your own", Scope.MENU),
    Action("forget", "delete", "take off", "Take the highlighted file off the list", Scope.MENU),
    Action("end_search", "escape", "show all", "Show all lessons and files again", Scope.MENU),
    Action("submit", "enter", "open", "Open what is highlighted", Scope.SEARCH),
    Action("above", "up", "choose", "Highlight what is above", Scope.SEARCH, "Highlight another"),
    Action("below", "down", "choose", "Highlight what is below", Scope.SEARCH, "Highlight another"),
    Action("give_up", "escape", "show all", "Show all lessons and files again", Scope.SEARCH),
    Action("go", "enter", "open", "Open the file", Scope.OPENING),
    Action("complete", "tab", "complete", "Complete the path as far as there is one way", Scope.OPENING),
    Action("close", "escape", "close", "Close the window, and open nothing", Scope.OPENING),
    Action("filter", "/", "filter", "Show some lines only, by words, level or writer", Scope.LOG),
    Action(
        "follow",
        "f",
        "follow",
        "Go to the end of the log, and follow it",
        Scope.LOG,
        "Follow the end of the log, or stay at these lines",
    ),
    Action(
        "stay",
        "f",
        "stay",
        "Stay at these lines of the log",
        Scope.LOG,
        "Follow the end of the log, or stay at these lines",
    ),
    Action("line_above", "up", "line", "Pick the line above", Scope.LOG, "Pick the line above or below"),
    Action("line_below", "down", "line", "Pick the line below", Scope.LOG, "Pick the line above or below"),
    Action("pick_line", "enter", "go there", "Move the cursor of every pane to the line's time", Scope.LOG),
    Action("copy", "y", "copy", "Copy the picked line, or those in view", Scope.LOG),
    Action("let_go", "escape", "let go", "Have no line picked", Scope.LOG),
    Action("line_above", "up", "line", "Go to the line above", Scope.CODE, "Go to the line above or below"),
    Action("line_below", "down", "line", "Go to the line below", Scope.CODE, "Go to the line above or below"),
    Action("pick_callback", "enter", "go to lane", "Go from the line's callback to its lane", Scope.CODE),
    Action("open_here", "o", "editor", "Open the file at the line in $EDITOR", Scope.CODE),
    Action("copy", "y", "copy", "Copy the callback at the line", Scope.CODE),
    Action("let_go", "escape", "let go", "Pick no line, and go to what runs again", Scope.CODE),
    Action("check_above", "up", "check", "Go to the check above", Scope.CHECKS, "Go to another check"),
    Action("check_below", "down", "check", "Go to the check below", Scope.CHECKS, "Go to another check"),
    Action("look_there", "enter", "look there", "Go to the moment that the check speaks of", Scope.CHECKS),
    Action("call_service", "s", "service", "Call the lesson's SetBool service with true", Scope.LESSON),
    Action("call_service_off", "S", "false", "Call the lesson's SetBool service with false", Scope.LESSON),
    Action("pause", "space", "pause", "Stop time for every thread", Scope.LESSON),
    Action("resume", "space", "go on", "Let time go on", Scope.LESSON),
    Action("live", "0", "live", "Go back to the present", Scope.LESSON),
    Action("predict", "P", "predict", "Say what you expect of the run; a given answer stays", Scope.LESSON),
    Action("explain", "a", "explain", "Tell what the run shows to be true, and why", Scope.LESSON),
    Action(
        "step",
        "full_stop",
        "step",
        "Go on by one decision, in a pause; looking back, by one event",
        Scope.LESSON,
    ),
    Action("run_again", "r", "run again", "Run again, when the run is over", Scope.LESSON),
    Action(
        "threads", "t", "threads", "Choose how many threads the executor gets, and run again", Scope.LESSON
    ),
    Action(
        "exercise",
        "e",
        "exercise",
        "Do the exercise, in a file of your own in the current folder",
        Scope.LESSON,
    ),
    Action("watch", "w", "watch", "Run your file again at the pace of real time", Scope.LESSON),
    Action("hint", "h", "hint", "Take the next hint for the exercise", Scope.LESSON),
    Action("lesson", "e", "lesson", "Go from the exercise back to its lesson", Scope.LESSON),
    Action("next_lesson", "n", "next", "Open the next lesson", Scope.LESSON),
    Action("solution", "H", "solution", "Look at the solution of the exercise", Scope.LESSON),
    Action("group", "g", "group", "Give the selected callback another group, and run again", Scope.LESSON),
    Action("set_up", "p", "set-up", "Change timers' periods and all else of the set-up", Scope.LESSON),
    Action("reset_world", "r", "reset", "Put the robot back to its start", Scope.LESSON),
    Action("compare", "C", "compare", "Compare this run with the one before", Scope.LESSON),
    Action(
        "diagnoses",
        "d",
        "diagnoses",
        "List what goes wrong in this run, why, and what to do about it",
        Scope.LESSON,
    ),
    *(
        Action(
            f"show_pane('{name}')",
            str(number),
            "pane",
            f"Go to the {name}",
            Scope.LESSON,
            f"Go to a pane: {', '.join(PANES)}",
        )
        for number, name in enumerate(PANES, start=1)
    ),
    Action(
        f"show_pane('{CHECKS}')",
        str(len(PANES) + 1),
        "pane",
        "Go to the checks of an exercise",
        Scope.LESSON,
    ),
    Action("prompt", "colon", "ros2", "Type a ros2 line; tab completes, up brings lines back", Scope.LESSON),
    Action("type", "i", "type", "Type for the program that reads from the keyboard", Scope.LESSON),
    Action("filter_log", "/", "filter", "Go to the log, and filter it", Scope.LESSON),
    Action("open_source", "o", "editor", "Open the code in $EDITOR", Scope.LESSON),
    Action(
        "record", "R", "record", "Begin a recording of the run in the current folder, or end it", Scope.LESSON
    ),
    Action(
        "export",
        "x",
        "export",
        "Make a picture, a report, a table or a trace of the run so far",
        Scope.LESSON,
    ),
    Action("start_over", "ctrl+r", "start over", "End this run, and run again, at any time", Scope.LESSON),
    Action("go_to_time", "G", "go to", "Look back at a moment, or run on until it has come", Scope.LESSON),
    Action(
        "cycle_camera", "c", "camera", "Show the robot's map, the camera's picture, or both", Scope.LESSON
    ),
    Action("step_back", "comma", "look back", "Look at the event before the moment on screen", Scope.LESSON),
    Action("earlier", "left_square_bracket", "look back", "Move the cursor of every pane back", Scope.LESSON),
    Action("later", "right_square_bracket", "look back", "Move the cursor of every pane on", Scope.LESSON),
    Action("slower", "minus", "speed", "Let time pass more slowly", Scope.LESSON),
    Action("faster", "plus", "speed", "Let time pass faster", Scope.LESSON),
    Action("zoom_out", "less_than_sign", "zoom", "Show a longer stretch of time", Scope.LESSON),
    Action("zoom_in", "greater_than_sign", "zoom", "Show a shorter stretch of time", Scope.LESSON),
    Action(
        "pan_earlier",
        "left",
        "pan",
        "Show an earlier stretch, and leave the cursor",
        Scope.LESSON,
        "Show an earlier or later stretch, and leave the cursor",
    ),
    Action(
        "pan_later",
        "right",
        "pan",
        "Show a later stretch, and leave the cursor",
        Scope.LESSON,
        "Show an earlier or later stretch, and leave the cursor",
    ),
    Action("select", "enter", "select", "Go to the lanes and select a bar, to see what it is", Scope.LESSON),
    Action("to_code", "enter", "code", "Go from the selected bar to its code", Scope.LESSON),
    Action(
        "lane_above",
        "up",
        "lane",
        "Select the lane above",
        Scope.LESSON,
        "Select the lane above or below, when on the lanes",
    ),
    Action(
        "lane_below",
        "down",
        "lane",
        "Select the lane below",
        Scope.LESSON,
        "Select the lane above or below, when on the lanes",
    ),
    Action(
        "previous_event",
        "left_curly_bracket",
        "event",
        "Go back to the selected lane's bar before",
        Scope.LESSON,
        "Go to the selected lane's bar before or after the cursor",
    ),
    Action(
        "next_event",
        "right_curly_bracket",
        "event",
        "Go on to the selected lane's next bar",
        Scope.LESSON,
        "Go to the selected lane's bar before or after the cursor",
    ),
    Action("deselect", "escape", "deselect", "Leave the lanes, and select nothing", Scope.LESSON),
    Action(
        "copy_details",
        "y",
        "copy",
        "Copy the selected bar's details, or else the moment's, as text",
        Scope.LESSON,
    ),
    Action("next_pane", "tab", "next pane", "Go to the next pane", Scope.LESSON),
    Action("maximise", "z", "enlarge", "Let one pane fill the screen; press again to go back", Scope.LESSON),
    Action(
        "enlarge_lanes", "Z", "enlarge", "Let the lanes fill the screen; press again to go back", Scope.LESSON
    ),
    Action("leave", "q", "menu", "End the run and go back to the menu", Scope.LESSON),
    Action("leave", "q", "quit", "Leave the console", Scope.MENU),
    Action(
        "window",
        "w",
        "whole or screen",
        "Let the table tell of whole runs, or of what is on screen",
        Scope.COMPARE,
    ),
    Action("earlier", "left_square_bracket", "look back", "Move the cursor back", Scope.COMPARE),
    Action("later", "right_square_bracket", "look back", "Move the cursor on", Scope.COMPARE),
    Action(
        "pan_earlier",
        "left",
        "pan",
        "Show an earlier stretch, and leave the cursor",
        Scope.COMPARE,
        "Show an earlier or later stretch, and leave the cursor",
    ),
    Action(
        "pan_later",
        "right",
        "pan",
        "Show a later stretch, and leave the cursor",
        Scope.COMPARE,
        "Show an earlier or later stretch, and leave the cursor",
    ),
    Action(
        "previous_event",
        "left_curly_bracket",
        "bar",
        "Go back to the lane's bar before",
        Scope.COMPARE,
        "Go to the clicked lane's bar before or after the cursor",
    ),
    Action(
        "next_event",
        "right_curly_bracket",
        "bar",
        "Go on to the lane's next bar",
        Scope.COMPARE,
        "Go to the clicked lane's bar before or after the cursor",
    ),
    Action("deselect", "escape", "deselect", "Select nothing", Scope.COMPARE),
    Action("zoom_out", "less_than_sign", "zoom", "Show a longer stretch of time", Scope.COMPARE),
    Action("zoom_in", "greater_than_sign", "zoom", "Show a shorter stretch of time", Scope.COMPARE),
    Action("go_to_time", "G", "go to", "Go to a moment", Scope.COMPARE),
    Action("live", "0", "end", "Go to the end", Scope.COMPARE),
    Action("maximise", "z", "table", "Let the table fill the screen; press again to go back", Scope.COMPARE),
    Action(
        "enlarge_lanes", "Z", "lanes", "Let the lanes fill the screen; press again to go back", Scope.COMPARE
    ),
    Action("scroll_table_up", "up", "scroll", "Show what lies above in the table", Scope.COMPARE),
    Action("scroll_table_down", "down", "scroll", "Show what lies below in the table", Scope.COMPARE),
    Action("step_back", "comma", "event", "Go to the event before, of either run", Scope.COMPARE),
    Action("step", "full_stop", "event", "Go to the next event, of either run", Scope.COMPARE),
    Action("leave", "q", "back", "Leave the comparison", Scope.COMPARE),
    Action("submit", "enter", "keep", "Go to the lines that the filter lets through", Scope.FILTER),
    Action("drop_filter", "escape", "clear", "Show every line again", Scope.FILTER),
    Action("submit", "enter", "run", "Carry out the line", Scope.PROMPT),
    Action("complete", "tab", "complete", "Complete the word at the cursor", Scope.PROMPT),
    Action("older", "up", "lines before", "Bring back the line before", Scope.PROMPT),
    Action("newer", "down", "lines before", "Go on to the line after", Scope.PROMPT),
    Action("interrupt", "ctrl+c", "interrupt", "End the line that goes on", Scope.PROMPT),
    Action("leave_prompt", "escape", "other keys", "Go back to the other keys", Scope.PROMPT),
    Action("submit", "enter", "give", "Give the line to the program that reads it", Scope.KEYBOARD),
    Action("interrupt", "ctrl+c", "interrupt", "Interrupt the program, as in any terminal", Scope.KEYBOARD),
    Action(
        "leave_keyboard",
        "ctrl+right_square_bracket",
        "other keys",
        "Go back to the other keys; the program gets every other key where it takes single ones",
        Scope.KEYBOARD,
    ),
    *(
        Action(f"choose({number})", str(number), "threads", f"Run with {number} threads", Scope.THREADS)
        for number in range(1, 9)
    ),
    Action("choose(0)", "o", "the program's own", "Run with the program's own number", Scope.THREADS),
    Action("close", "escape,q", "close", "Close the window, and leave everything as it is", Scope.THREADS),
    *(
        Action(f"choose('{name}')", key, "group", f"Give it {group}", Scope.GROUP)
        for key, name, group in (
            ("o", "own", "a group of its own"),
            ("s", "shared", "the shared group"),
            ("r", "reentrant", "the reentrant group"),
            ("d", "default", "the node's default group"),
        )
    ),
    Action("choose('')", "p", "the program's", "Give it the group that the program says", Scope.GROUP),
    Action("close", "escape,q", "close", "Close the window, and leave everything as it is", Scope.GROUP),
    *(
        Action(f"choose('{name}')", key, "format", f"Export {what}", Scope.EXPORT)
        for key, name, what in (
            ("p", "picture", "a picture of the stretch on screen"),
            ("w", "whole", "a picture of the whole run"),
            ("r", "report", "a report"),
            ("t", "table", "a table of the calls"),
            ("u", "perfetto", "a trace for ui.perfetto.dev"),
            ("c", "chrome", "a trace for chrome://tracing and Speedscope"),
        )
    ),
    Action("close", "escape,q", "close", "Close the window, and export nothing", Scope.EXPORT),
    Action("change", "enter", "change", "Change what is highlighted", Scope.SETUP),
    Action("run", "r", "run with it", "Run again with what is changed", Scope.SETUP),
    Action("undo_all", "u", "undo all", "Have everything as the program says", Scope.SETUP),
    Action("close", "escape,q", "close", "Close the window, and let the run go on as it is", Scope.SETUP),
    Action("previous", "up", "choose", "Highlight what is above", Scope.DIAGNOSES, "Highlight another"),
    Action("next", "down", "choose", "Highlight what is below", Scope.DIAGNOSES, "Highlight another"),
    Action("go", "enter", "go there", "Go to the moment and to the code", Scope.DIAGNOSES),
    Action("close", "escape,q", "close", "Close the window, and stay where you are", Scope.DIAGNOSES),
    *(
        Action(
            f"choose({number})",
            str(number),
            "choose",
            f"Highlight answer {number}",
            Scope.PREDICTION,
            "Highlight the answer with this number",
        )
        for number in range(1, 6)
    ),
    Action("previous", "up", "choose", "Highlight what is above", Scope.PREDICTION, "Highlight another"),
    Action("next", "down", "choose", "Highlight what is below", Scope.PREDICTION, "Highlight another"),
    Action("take", "enter", "answer", "Give the highlighted answer, for good", Scope.PREDICTION),
    Action("skip", "escape", "without predicting", "Go on without an answer", Scope.PREDICTION),
    Action("page_up", "pageup", "scroll", "Scroll the text up", Scope.PREDICTION),
    Action("page_down", "pagedown", "scroll", "Scroll the text down", Scope.PREDICTION),
    Action("close", "q", "back", "Go back to where you came from", Scope.PREDICTION),
    Action("show_whole", "d", "whole file", "Show the whole solution", Scope.SOLUTION),
    Action("show_difference", "d", "what differs", "Show only what differs", Scope.SOLUTION),
    Action("close", "escape,q", "close", "Close the window", Scope.SOLUTION),
    Action("take", "enter", "look at it", "Look at the solution", Scope.ASKING),
    Action("close", "escape,q", "not yet", "Close the window, and look at nothing", Scope.ASKING),
    Action("go", "enter", "take", "Take the number", Scope.NUMBER),
    Action("close", "escape", "close", "Close the window, and leave the number as it is", Scope.NUMBER),
    Action("go", "enter", "go", "Go to the moment", Scope.MOMENT),
    Action("close", "escape", "close", "Close the window, and stay where you are", Scope.MOMENT),
    Action("close", "escape,q,question_mark", "close", "Go back to where you were", Scope.HELP),
    Action("command_palette", "ctrl+p", "commands", "Find any command, and colour themes", Scope.EVERYWHERE),
    Action("help", "question_mark", "help", "Show every key and what it does", Scope.EVERYWHERE),
)


def actions_of(scope: Scope) -> tuple[Action, ...]:
    """Return the actions that work in a scope, on a pane also those of its lesson.

    Actions of ``EVERYWHERE`` are left out in windows and while text is typed.
    """
    if scope in _ON_A_PANE:
        scopes: tuple[Scope, ...] = (scope, Scope.LESSON, Scope.EVERYWHERE)
    else:
        scopes = (scope,) if scope in _ALONE else (scope, Scope.EVERYWHERE)
    return tuple(action for action in ACTIONS if action.scope in scopes)
