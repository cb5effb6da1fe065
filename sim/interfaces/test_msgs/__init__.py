"""The modules of the package test_msgs, besides its interfaces."""
