"""What concerns the Python interpreter itself: functions on a stack, the module path, exceptions."""
