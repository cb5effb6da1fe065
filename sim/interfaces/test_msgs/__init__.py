"""What the package test_msgs has beside its interfaces."""
