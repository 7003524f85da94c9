"""The door for facts about tasks: YAML, JSON and spreadsheets in, tasks ready to be scored out."""
