"""What facts about tasks come to, told to people: sentences, and pages that can be signed."""
