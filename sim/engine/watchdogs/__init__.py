"""What notices programs that wait, hang or spin, and names the places."""
