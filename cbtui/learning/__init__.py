"""What a learner goes through: pages, predictions, exercises and progress; and the proof of a lesson."""
